#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <pliant/backend/in_turn.hpp>
#include <pliant/cuda/context.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/scan.cuh>
#include <pliant/cuda/sort.cuh>
#include <pliant/cuda/tuning.hpp>

// Short loops, scans and sorts that one block does one after the other.
namespace pliant::detail {

template <class F>
__device__ void do_step(LoopStep<F> const& step, std::byte*) {
  for (Index i = static_cast<Index>(threadIdx.x); i < step.n; i += list_threads) step.f(i);
}
template <class F>
__device__ void do_step(ScanStep<F> const& step, std::byte*) {
  Index const sum = store_part(ListPart(step.n, list_threads), step.f, StoreSums{step.to}, 0);
  if (threadIdx.x == 0) step.to[step.n] = sum;
}
__device__ inline void do_step(SortStep const& step, std::byte* scratch) {
  using List = KeyList<std::uint64_t, Index>;
  auto* const keys = reinterpret_cast<std::uint64_t*>(scratch);
  if (step.n > 1)
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
      __syncthreads();
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

/// Whether one block does all of some steps.
template <class... Steps>
bool are_short(Steps const&... steps) {
  return std::max({steps.n...}) <= short_steps;
}
template <class... Steps>
void do_in_turn(CudaContext& context, Steps const&... steps) {
  auto const device = context.stream()->enter();
  auto const most = static_cast<std::size_t>(std::max({steps.n...}));
  auto const list = list_of_steps(steps...);
  launch(Start::early, "in_turn", {1, list_threads}, context.stream()->get(),
         do_steps<std::remove_const_t<decltype(list)>>, list,
         context.scratch().take(most * (sizeof(std::uint64_t) + sizeof(Index))));
}

}  // namespace pliant::detail
