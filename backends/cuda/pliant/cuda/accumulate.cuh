#pragma once

#include <pliant/backend/dispatch.hpp>
#include <pliant/cuda/elements.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/patch_loop.cuh>
#include <pliant/cuda/patch_memory.cuh>

namespace pliant::detail {

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
__device__ __forceinline__ auto call_on_rows(Kernel const& kernel, Group group, Index e,
                                             T const (&rows)[Nodes][M]) {
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    constexpr auto offset = [](std::size_t field) {
      int const sizes[] = {C...};
      int sum = 0;
      for (std::size_t k = 0; k < field; ++k) sum += sizes[k];
      return sum;
    };
    return call(kernel, group, OneElement{e}, columns<offset(I), C>(rows)...);
  }(std::make_index_sequence<sizeof...(C)>());
}

/// One block per patch: nodes to shared memory, elements' shares to their slots, slots summed by
/// node, sums added to global memory.
template <int Groups, int Nodes, class T, int C, class Kernel, class... Fields>
__global__ void __launch_bounds__(patch_tuning<T, Nodes>().max_threads,
                                  (resident_blocks<T, Nodes, Kernel>))
    accumulate_patches(PatchView<Nodes> const patches, __grid_constant__ Kernel const kernel,
                       NodeField<T, C> const out, Fields... fields) {
  constexpr auto tuning = patch_tuning<T, Nodes>();
  constexpr int M = (Fields::components + ... + 0);
  extern __shared__ __align__(16) char shared_memory[];
  PatchMemory<T, Nodes, C, M> const memory(patches.diagonal_capacity, patches.node_capacity,
                                           shared_memory);
  // Another kernel may have written the list.
  if (patches.active.list != nullptr) begin_after_previous_kernel();
  Index const patch = patches.active.patch(static_cast<Index>(blockIdx.x));
  if (patch < 0) return;
  Index const thread = static_cast<Index>(threadIdx.x);
  Index const threads = static_cast<Index>(blockDim.x);
  PatchNode const* const nodes =
      patches.nodes + static_cast<std::ptrdiff_t>(patch) * patches.node_capacity;
  Index e = patch * patches.patch_size + thread;
  PatchLoop loop(patches.rounds);
  auto const is_element = [&] { return loop.has_rounds() && e < patches.count; };

  // What does not depend on each other is loaded early: memory is far.
  using Places = Packed<PatchRow<Nodes>>;
  Places places;
  if (is_element()) places = Places::load(patches.rows + e);
  auto const node_at = [&](Index r) { return r < patches.node_capacity ? nodes[r].node : -1; };
  Index next_node = node_at(thread);
#pragma unroll 1
  for (Index d = thread; d < patches.diagonal_capacity; d += threads)
    memory.diagonals[d] =
        patches.diagonals[static_cast<std::ptrdiff_t>(patch) * patches.diagonal_capacity + d];
  begin_after_previous_kernel();
  Tag const first_tag = is_element() ? patches.tags[e] : Tag{0};
#pragma unroll 1
  for (Index r = thread; r < patches.node_capacity; r += threads) {
    Index const node = next_node;
    if (node < 0) break;  // behind the patch's last
    next_node = node_at(r + threads);
    T row[M];
    int offset = 0;
    ((load_node(fields, node, row + offset), offset += Fields::components), ...);
    memory.rows.store(r, row);
  }
  loop.set_tag(first_tag);
  __syncthreads();

#pragma unroll 1
  while (is_element()) {
    Places const own = places;
    Tag const own_tag = loop.tag();
    T values[Nodes][M];
#pragma unroll
    for (int a = 0; a < Nodes; ++a) memory.rows.load(own.unpacked().local[a], values[a]);
    Index const own_element = e;
    e += threads;
    loop.next_round(own_tag < Groups);
    auto const load_next = [&] {
      if (!is_element()) return;
      places = Places::load(patches.rows + e);
      loop.set_tag(patches.tags[e]);
    };
    if constexpr (tuning.prefetch) load_next();
    auto const store = [&](Matrix<T, Nodes, C> const& shares) {
#pragma unroll
      for (int a = 0; a < Nodes; ++a)
        store_values<C>(memory.staging + C * own.unpacked().slot[a], shares.entries[a]);
    };
    dispatch<Groups>(own_tag, [&](auto group) {
      store(call_on_rows<Fields::components...>(opaque<LightKernel<Kernel>>(kernel), group,
                                                own_element, values));
    });
    if (own_tag >= Groups) store(Matrix<T, Nodes, C>::zero());
    if constexpr (!tuning.prefetch) load_next();
  }
  auto const sum_at = [&](Index r) { return r < patches.node_capacity ? nodes[r] : PatchNode{}; };
  PatchNode next_sum = sum_at(thread);
  if (!__syncthreads_or(loop.acted())) return;  // no element of the patch acts

#pragma unroll 1
  for (Index r = thread; r < patches.node_capacity; r += threads) {
    PatchNode const n = next_sum;
    if (n.valence == 0) break;  // behind the patch's last
    next_sum = sum_at(r + threads);
    T sum[C] = {};
#pragma unroll 4
    for (int d = 0; d < n.valence; ++d) {
      T share[C];
      load_values<C>(memory.staging + C * (memory.diagonals[d] + r), share);
#pragma unroll
      for (int k = 0; k < C; ++k) sum[k] += share[k];
    }
    add_to_node(out, n.node, sum);
  }
}

}  // namespace pliant::detail
