#pragma once

#include <pliant/backend/dispatch.hpp>
#include <pliant/cuda/elements.hpp>
#include <pliant/cuda/node_rows.cuh>

namespace pliant::detail {

/// What a block of accumulation keeps in shared memory, in this order.
template <class T, int Nodes, int C, int M>
struct PatchMemory {
  static constexpr int diagonal_bytes(int capacity) { return (capacity * 2 + 15) / 16 * 16; }
  static int bytes(PatchView<Nodes> const& patches) {
    return diagonal_bytes(patches.diagonal_capacity) +
           NodeRows<T, M>::bytes(patches.node_capacity) +
           patches.patch_size * Nodes * C * int{sizeof(T)};
  }
  __device__ explicit PatchMemory(PatchView<Nodes> const& patches, char* memory)
      : diagonals(reinterpret_cast<std::uint16_t*>(memory)),
        rows{reinterpret_cast<T*>(memory + diagonal_bytes(patches.diagonal_capacity)),
             patches.node_capacity},
        staging(rows.data + NodeRows<T, M>::width * patches.node_capacity),
        slots(patches.patch_size * Nodes) {}

  std::uint16_t* diagonals;
  NodeRows<T, M> rows;
  T* staging;  // (C, slots): a component's slots side by side
  int slots;
};

/// Some columns of the node rows of an element.
template <int Offset, int C, class T, int Nodes, int M>
__device__ __forceinline__ Matrix<T, Nodes, C> columns(T const (&rows)[Nodes][M]) {
  Matrix<T, Nodes, C> values;
#pragma unroll
  for (int a = 0; a < Nodes; ++a)
#pragma unroll
    for (int k = 0; k < C; ++k) values(a, k) = rows[a][Offset + k];
  return values;
}

/// kernel(group, fields...) with the fields cut out of node rows.
template <int... C, class Group, class Kernel, class T, int Nodes, int M>
__device__ __forceinline__ auto call_on_rows(Kernel const& kernel, Group group,
                                             T const (&rows)[Nodes][M]) {
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    constexpr auto offset = [](std::size_t field) {
      int const sizes[] = {C...};
      int sum = 0;
      for (std::size_t k = 0; k < field; ++k) sum += sizes[k];
      return sum;
    };
    return kernel(group, columns<offset(I), C>(rows)...);
  }
  (std::make_index_sequence<sizeof...(C)>());
}

/// One block per patch: nodes to shared memory, elements' shares to their slots, slots summed by
/// node, sums added to global memory.
template <int Groups, int Nodes, class T, int C, class Kernel, class... Fields>
__global__ void __launch_bounds__(patch_tuning<T, Nodes>().max_threads,
                                  patch_tuning<T, Nodes>().min_blocks)
    accumulate_patches(PatchView<Nodes> const patches, __grid_constant__ Kernel const kernel,
                       NodeField<T, C> const out, Fields... fields) {
  constexpr int M = (Fields::components + ... + 0);
  extern __shared__ __align__(16) char shared_memory[];
  PatchMemory<T, Nodes, C, M> const memory(patches, shared_memory);
  Index const* const nodes =
      patches.nodes + static_cast<std::ptrdiff_t>(blockIdx.x) * patches.node_capacity;

  for (int r = static_cast<int>(threadIdx.x); r < patches.node_capacity; r += blockDim.x) {
    Index const node = nodes[r];
    if (node < 0) continue;
    T row[M];
    int offset = 0;
    ((load_node(fields, node, row + offset), offset += Fields::components), ...);
    memory.rows.store(r, row);
  }
  for (int d = static_cast<int>(threadIdx.x); d < patches.diagonal_capacity; d += blockDim.x)
    memory.diagonals[d] =
        patches.diagonals[static_cast<std::ptrdiff_t>(blockIdx.x) * patches.diagonal_capacity + d];
  __syncthreads();

  bool any = false;
  Index const first = static_cast<Index>(blockIdx.x) * patches.patch_size;
  Index const last = ::min(patches.count, first + patches.patch_size);
  for (Index e = first + static_cast<Index>(threadIdx.x); e < last; e += blockDim.x) {
    PatchRow<Nodes> const places = load_whole(patches.rows + e);
    T values[Nodes][M];
#pragma unroll
    for (int a = 0; a < Nodes; ++a) memory.rows.load(places.local[a], values[a]);
    auto shares = Matrix<T, Nodes, C>::zero();
    dispatch<Groups>(patches.tags[e], [&](auto group) {
      shares = call_on_rows<Fields::components...>(kernel, group, values);
      any = true;
    });
#pragma unroll
    for (int a = 0; a < Nodes; ++a)
#pragma unroll
      for (int k = 0; k < C; ++k) memory.staging[k * memory.slots + places.slot[a]] = shares(a, k);
  }
  if (!__syncthreads_or(any)) return;  // no element of the patch acts

  std::uint16_t const* const valences =
      patches.valences + static_cast<std::ptrdiff_t>(blockIdx.x) * patches.node_capacity;
  for (int r = static_cast<int>(threadIdx.x); r < patches.node_capacity; r += blockDim.x) {
    Index const node = nodes[r];
    if (node < 0) continue;
    int const valence = valences[r];
    T sum[C] = {};
#pragma unroll 4
    for (int d = 0; d < valence; ++d)
#pragma unroll
      for (int k = 0; k < C; ++k)
        sum[k] += memory.staging[k * memory.slots + memory.diagonals[d] + r];
    add_to_node(out, node, sum);
  }
}

}  // namespace pliant::detail
