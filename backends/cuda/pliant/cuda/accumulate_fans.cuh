#pragma once

#include <pliant/backend/dispatch.hpp>
#include <pliant/cuda/elements.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/nodes_of_patch.cuh>
#include <pliant/cuda/patch_loop.cuh>

namespace pliant::detail {

/// Bytes for the tags of a patch's elements.
inline constexpr int tag_bytes(int patch_size) { return (patch_size + 3) / 4 * 4; }

/// The tags of n elements to shared memory, four at a time where they are aligned.
__device__ __forceinline__ void load_tags(Tag const* tags, Index n, Tag* to) {
  static_assert(sizeof(Tag) == 1);
  Index const threads = static_cast<Index>(blockDim.x);
  bool const aligned = reinterpret_cast<std::uintptr_t>(tags) % 4 == 0;
  Index const in_fours = aligned ? n / 4 * 4 : 0;
#pragma unroll 1
  for (Index i = 4 * static_cast<Index>(threadIdx.x); i < in_fours; i += 4 * threads)
    *reinterpret_cast<std::uint32_t*>(to + i) = *reinterpret_cast<std::uint32_t const*>(tags + i);
#pragma unroll 1
  for (Index i = in_fours + static_cast<Index>(threadIdx.x); i < n; i += threads) to[i] = tags[i];
}

/// A value that is not worked out again where it is used: a loop's compiler would rather subtract in each round than
/// keep what it subtracts from and the difference.
template <class T>
__device__ __forceinline__ T kept_in_register(T x) {
  if constexpr (sizeof(T) == 4)
    asm volatile("" : "+f"(x));
  else
    asm volatile("" : "+d"(x));
  return x;
}

/// The visits of a fan's first element.
struct FanStart {
  FanVisit visit[4];
};

/// One block per patch, as accumulate_patches, but a thread goes around an edge, from tetrahedron to tetrahedron: a node
/// is loaded once for all that have it, and gets the sum of their shares.
template <int Groups, class T, int C, class Kernel, class... Fields>
__global__ void __launch_bounds__(fan_tuning<T>().max_threads, (fan_blocks<T, Kernel>))
    accumulate_fans(PatchView<FanVisit> const patches, __grid_constant__ Kernel const kernel,
                    NodeField<T, C> const out, Fields... fields) {
  constexpr int M = (Fields::components + ... + 0);
  extern __shared__ __align__(16) char shared_memory[];
  PatchMemory<T, C, M> const memory(patches.capacity, shared_memory);
  auto const tags = reinterpret_cast<Tag*>(memory.staging + C * patches.capacity.slots);
  // Another kernel may have written the list.
  if (patches.active.list != nullptr) begin_after_previous_kernel();
  Index const patch = patches.active.patch(static_cast<Index>(blockIdx.x));
  if (patch < 0) return;
  Index const thread = static_cast<Index>(threadIdx.x);
  Index const threads = static_cast<Index>(blockDim.x);
  NodesOfPatch const nodes = patches.nodes_of(patch);
  int const fans = patches.capacity.fans;
  FanVisit const* const visits =
      patches.units + static_cast<std::ptrdiff_t>(patch) * most_fan_visits * fans;
  auto const first_visits = [&](int fan) {
    FanStart start{};
    if (fan < fans)
#pragma unroll
      for (int j = 0; j < 4; ++j) start.visit[j] = visits[j * fans + fan];
    return start;
  };

  // What does not depend on each other is loaded early: memory is far.
  Index const first_element = patches.first[patch], end = patches.first[patch + 1];
  FanStart start = first_visits(thread);
  auto const first_nodes = nodes.batch<2>(thread);
  patches.load_diagonals(patch, memory.diagonals);
  begin_after_previous_kernel();
  load_tags(patches.tags + first_element, end - first_element, tags);
  nodes.load(memory.rows, first_nodes, fields...);
  __syncthreads();

  bool acted = false;
#pragma unroll 1
  for (int fan = thread; start.visit[0].element() > 0; fan += threads) {  // behind the last: 0
    int const size = start.visit[0].element();
    T origin[M], values[4][M];
    memory.rows.load(start.visit[0].node(), origin);
    auto const load = [&](FanVisit at, T(&row)[M]) {
      memory.rows.load(at.node(), row);
#pragma unroll
      for (int k = 0; k < M; ++k) row[k] = kept_in_register(row[k] - origin[k]);
    };
#pragma unroll
    for (int k = 0; k < M; ++k) values[0][k] = T(0);
    load(start.visit[1], values[1]);
    load(start.visit[2], values[2]);
    int slot = start.visit[2].slot();
    FanVisit own = start.visit[3];
    FanVisit const* visit = visits + 3 * fans + fan;
    T of_other[C] = {}, around[C] = {}, of_last[C] = {};  // shares, added up
#pragma unroll 1
    for (int i = 1; i <= size; ++i) {
      FanVisit next;
      if (i < size) next = visit[i * fans];
      load(own, values[3]);
      T* const to = memory.staging + C * slot;
      slot = own.slot();
      Tag const tag = tags[own.element()];
      dispatch<Groups>(tag, [&](auto group) {
        auto const shares = call_on_rows<Fields::components...>(
            opaque<LightKernel<Kernel>>(kernel), group, first_element + own.element(), values);
#pragma unroll
        for (int k = 0; k < C; ++k) {
          of_other[k] += shares(1, k);
          of_last[k] += shares(2, k);
          around[k] += of_last[k];
        }
        store_values<C>(to, of_last);
#pragma unroll
        for (int k = 0; k < C; ++k) of_last[k] = shares(3, k);
        acted = true;
      });
      if (tag >= Groups) {
        store_values<C>(to, of_last);
#pragma unroll
        for (int k = 0; k < C; ++k) {
          around[k] += of_last[k];
          of_last[k] = T(0);
        }
      }
#pragma unroll
      for (int k = 0; k < M; ++k) values[2][k] = values[3][k];
      own = next;
    }
#pragma unroll
    for (int k = 0; k < C; ++k) around[k] = -(around[k] + of_last[k] + of_other[k]);
    store_values<C>(memory.staging + C * visits[fan].slot(), around);  // all add up to zero
    T* const last = memory.staging + C * slot;
    if (slot == visits[2 * fans + fan].slot()) {
#pragma unroll
      for (int k = 0; k < C; ++k) of_last[k] += last[k];
    }
    store_values<C>(last, of_last);
    store_values<C>(memory.staging + C * visits[fans + fan].slot(), of_other);
    start = first_visits(fan + threads);
  }
  PatchNode const first_sum = nodes.at(thread);
  if (!__syncthreads_or(acted)) return;  // no element of the patch acts
  nodes.add_sums(out, memory.diagonals, memory.staging, first_sum);
}

}  // namespace pliant::detail
