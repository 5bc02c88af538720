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

// Short loops, scans and sorts that one launch does one after the other: a block, or a cluster of blocks that share loops.
namespace pliant::detail {

template <class F>
__device__ void do_step(LoopStep<F> const& step, std::byte*) {
  auto const own = static_cast<Index>(blockIdx.x * list_threads + threadIdx.x);
  for (Index i = own; i < step.n; i += static_cast<Index>(gridDim.x * list_threads)) step.f(i);
}
/// A value for each thread, and the sums of blocks for those behind them; or all by one block.
template <class F>
__device__ void do_step(ScanStep<F> const& step, std::byte* scratch) {
  if (step.n > static_cast<Index>(gridDim.x * list_threads)) {
    if (blockIdx.x > 0) return;
    Index const sum = store_part(ListPart(step.n), step.f, StoreSums{step.to}, 0);
    if (threadIdx.x == 0) step.to[step.n] = sum;
    return;
  }
  auto const own = static_cast<Index>(blockIdx.x * list_threads + threadIdx.x);
  Index const value = own < step.n ? step.f(own) : 0;
  Index of_block = 0;
  Index sum = scan_block(value, of_block);
  if (gridDim.x > 1) {
    auto* const sums = reinterpret_cast<Index*>(scratch);
    if (threadIdx.x == 0) sums[blockIdx.x] = of_block;
    wait_for_cluster();
    for (unsigned b = 0; b < blockIdx.x; ++b) sum += sums[b];
  }
  if (own < step.n) step.to[own] = sum;
  if (own == max(step.n, Index{1}) - 1) step.to[step.n] = sum + value;
}
/// Whether keys of so many bits leave room for their numbers in a word.
template <class Word>
__device__ constexpr bool holds_numbers(int bits) {
  return bits + bits_of_short_steps <= 8 * static_cast<int>(sizeof(Word));
}
/// A key for each thread, which goes to the place that as many come before. Words of keys and, lowest, of their numbers tell
/// which do.
template <class Word>
__device__ void sort_by_counting(SortStep const& step, KeyList<std::uint64_t, Index> const& other) {
  constexpr int at_once = 16 / sizeof(Word);  // in one look at memory
  struct alignas(16) Words {
    Word word[at_once];
  };
  __shared__ Words words[short_steps / at_once];
  Index const parts = (step.n - 1) / at_once + 1;
  for (auto i = static_cast<Index>(threadIdx.x); i < at_once * parts; i += list_threads) {
    Word const key = i < step.n ? static_cast<Word>(step.keys[i]) : 0;
    words[i / at_once].word[i % at_once] =
        i < step.n ? (key << bits_of_short_steps | static_cast<Word>(i)) : ~Word{0};
  }
  __syncthreads();
  auto const own = static_cast<Index>(blockIdx.x * list_threads + threadIdx.x);
  if (own < step.n) {
    Word const word = words[own / at_once].word[own % at_once];
    Index before[at_once] = {};
#pragma unroll 8
    for (Index i = 0; i < parts; ++i) {
      Words const some = words[i];
#pragma unroll
      for (int k = 0; k < at_once; ++k) before[k] += some.word[k] < word ? 1 : 0;
    }
    Index place = 0;
    for (int k = 0; k < at_once; ++k) place += before[k];
    other.keys[place] = step.keys[own];
    other.values[place] = step.values[own];
  }
  wait_for_cluster();
  if (own >= step.n) return;
  step.keys[own] = other.keys[own];
  step.values[own] = other.values[own];
}
__device__ inline void do_step(SortStep const& step, std::byte* scratch) {
  using List = KeyList<std::uint64_t, Index>;
  if (step.n <= 1) return;
  auto* const keys = reinterpret_cast<std::uint64_t*>(scratch);
  List const other{keys, reinterpret_cast<Index*>(keys + step.n)};
  bool const has_threads = step.n <= static_cast<Index>(gridDim.x * list_threads);
  if (has_threads && holds_numbers<std::uint32_t>(step.bits))
    sort_by_counting<std::uint32_t>(step, other);
  else if (has_threads && holds_numbers<std::uint64_t>(step.bits))
    sort_by_counting<std::uint64_t>(step, other);
  else if (blockIdx.x == 0)
    sort_all(step.n, List{step.keys, step.values}, other, step.bits);
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
      wait_for_cluster();
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
         context.scratch().take(static_cast<std::size_t>(std::max<Index>(most, step_cluster)) *
                                (sizeof(std::uint64_t) + sizeof(Index))));
}

}  // namespace pliant::detail
