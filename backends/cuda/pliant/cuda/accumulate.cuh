#pragma once

#include <pliant/backend/dispatch.hpp>
#include <pliant/cuda/elements.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/nodes_of_patch.cuh>
#include <pliant/cuda/patch_loop.cuh>

namespace pliant::detail {

/// One block per patch: nodes to shared memory, elements' shares to their slots, slots summed by
/// node, sums added to global memory.
template <int Groups, int Nodes, class T, int C, class Kernel, class... Fields>
__global__ void __launch_bounds__(patch_tuning<T, Nodes>().max_threads,
                                  (resident_blocks<T, Nodes, Kernel>))
    accumulate_patches(PatchView<PatchRow<Nodes>> const patches,
                       __grid_constant__ Kernel const kernel, NodeField<T, C> const out,
                       Fields... fields) {
  constexpr auto tuning = patch_tuning<T, Nodes>();
  constexpr int M = (Fields::components + ... + 0);
  extern __shared__ __align__(16) char shared_memory[];
  PatchMemory<T, C, M> const memory(patches.capacity, shared_memory);
  // Another kernel may have written the list.
  if (patches.active.list != nullptr) begin_after_previous_kernel();
  Index const patch = patches.active.patch(static_cast<Index>(blockIdx.x));
  if (patch < 0) return;
  Index const thread = static_cast<Index>(threadIdx.x);
  Index const threads = static_cast<Index>(blockDim.x);
  NodesOfPatch const nodes = patches.nodes_of(patch);

  // What does not depend on each other is loaded early: memory is far.
  Index const first = patches.first[patch], end = patches.first[patch + 1];
  using Places = Packed<PatchRow<Nodes>>;
  auto const first_nodes = nodes.batch<1>(thread);
  Index e = first + thread;
  PatchLoop loop(end - first, thread, threads);
  Places places;
  if (loop.has_rounds()) places = Places::load(patches.units + e);
  patches.load_diagonals(patch, memory.diagonals);
  begin_after_previous_kernel();
  Tag const first_tag = loop.has_rounds() ? patches.tags[e] : Tag{0};
  nodes.load(memory.rows, first_nodes, fields...);
  loop.set_tag(first_tag);
  __syncthreads();

#pragma unroll 1
  while (loop.has_rounds()) {
    Places const own = places;
    Tag const own_tag = loop.tag();
    T values[Nodes][M];
#pragma unroll
    for (int a = 0; a < Nodes; ++a) memory.rows.load(own.unpacked().local[a], values[a]);
    Index const own_element = e;
    e += threads;
    loop.next_round(own_tag < Groups);
    auto const load_next = [&] {
      if (!loop.has_rounds()) return;
      places = Places::load(patches.units + e);
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
  PatchNode const first_sum = nodes.at(thread);
  if (!__syncthreads_or(loop.acted())) return;  // no element of the patch acts
  nodes.add_sums(out, memory.diagonals, memory.staging, first_sum);
}

}  // namespace pliant::detail
