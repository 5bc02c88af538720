#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <cooperative_groups.h>

#include <pliant/backend/in_turn.hpp>
#include <pliant/cuda/context.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/scan.cuh>
#include <pliant/cuda/sort.cuh>
#include <pliant/cuda/tuning.hpp>

// Short loops, scans and sorts that one launch does one after the other: a block, or a cluster of blocks that share loops.
namespace pliant::detail {

/// All threads of the launch: what any wrote before, all see then.
__device__ inline void meet_in_turn() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  if (gridDim.x > 1) return cooperative_groups::this_cluster().sync();
#endif
  __syncthreads();
}

template <class F>
__device__ void do_step(LoopStep<F> const& step, std::byte*) {
  auto const own = static_cast<Index>(blockIdx.x * list_threads + threadIdx.x);
  for (Index i = own; i < step.n; i += static_cast<Index>(gridDim.x * list_threads)) step.f(i);
}
template <class F>
struct NoteValue {
  F f;
  Index* notes;
  __device__ void operator()(Index i) const { notes[i] = f(i); }
};
template <class F>
__device__ void do_step(ScanStep<F> const& step, std::byte* scratch) {
  do_step(LoopStep{step.n, NoteValue<F>{step.f, step.to}}, scratch);
  meet_in_turn();
  if (blockIdx.x > 0) return;
  Index const sum = store_part(ListPart(step.n), Noted<Index>{step.to}, StoreSums{step.to}, 0);
  if (threadIdx.x == 0) step.to[step.n] = sum;
}
__device__ inline void do_step(SortStep const& step, std::byte* scratch) {
  using List = KeyList<std::uint64_t, Index>;
  auto* const keys = reinterpret_cast<std::uint64_t*>(scratch);
  if (step.n > 1 && blockIdx.x == 0)
    sort_all(step.n, List{step.keys, step.values},
             List{keys, reinterpret_cast<Index*>(keys + step.n)}, step.bits);
}

/// Steps as a kernel takes them.
template <class... Steps>
struct StepList {
  __device__ void run(std::byte*) const {}
};
template <class First, class... Rest>
struct StepList<First, Rest...> {
  First first;
  StepList<Rest...> rest;

  __device__ void run(std::byte* scratch) const {
    do_step(first, scratch);
    if constexpr (sizeof...(Rest) > 0) {
      meet_in_turn();
      rest.run(scratch);
    }
  }
};
template <class First, class... Rest>
auto list_of_steps(First const& first, Rest const&... rest) {
  if constexpr (sizeof...(Rest) == 0)
    return StepList<First>{first, {}};
  else
    return StepList<First, Rest...>{first, list_of_steps(rest...)};
}

template <class List>
__global__ void __launch_bounds__(list_threads)
    do_steps(__grid_constant__ List const steps, std::byte* scratch) {
  begin_after_previous_kernel();
  steps.run(scratch);
}

/// Whether one launch does all of some steps.
template <class... Steps>
bool are_short(Steps const&... steps) {
  return std::max({steps.n...}) <= short_steps;
}
template <class... Steps>
void do_in_turn(CudaContext& context, Steps const&... steps) {
  auto const device = context.stream()->enter();
  Index const most = std::max({steps.n...});
  auto const list = list_of_steps(steps...);
  auto* const kernel = do_steps<std::remove_const_t<decltype(list)>>;
  static bool const can_be_cluster =
      clusters_can_be_launched(reinterpret_cast<void const*>(kernel), context.stream()->device());
  int const blocks =
      can_be_cluster ? std::clamp<Index>((most - 1) / list_threads + 1, 1, step_cluster) : 1;
  launch(Start::early, "in_turn", {blocks, list_threads, 0, blocks}, context.stream()->get(),
         kernel, list,
         context.scratch().take(static_cast<std::size_t>(most) *
                                (sizeof(std::uint64_t) + sizeof(Index))));
}

}  // namespace pliant::detail
