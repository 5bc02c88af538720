#pragma once

#include <algorithm>
#include <cstdint>

#include <pliant/cuda/context.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/tuning.hpp>

// scan and select: each block takes a part of the list. A first kernel calls the function, notes what it gives, and sums it over
// each part; a second one stores sums. For a short list one block does both at once.
namespace pliant::detail {

/// Of [0, n), for a block: whole rounds of `round`, but for the last. 64 bits: a round may pass the largest Index.
struct ListPart {
  std::int64_t first, last;
  __device__ ListPart(Index n, int round) {
    std::int64_t const rounds = (std::int64_t{n} + round - 1) / round;
    first = rounds * blockIdx.x / gridDim.x * round;
    last = min(rounds * (blockIdx.x + 1) / gridDim.x * round, std::int64_t{n});
  }
  /// All of it, for a block alone.
  __device__ explicit ListPart(Index n) : first(0), last(n) {}
};
/// The blocks that share a list.
inline Index list_blocks(Index n, int round) {
  if (n <= short_list) return 1;
  return std::min<Index>((n - 1) / round + 1, most_list_blocks);
}

/// The sum of `value` over the threads before this one; `total`: over all of the block.
__device__ inline Index scan_block(Index value, Index& total) {
  constexpr int warps = list_threads / warp_size;
  __shared__ Index of_warp[warps];
  int const lane = static_cast<int>(threadIdx.x) % warp_size;
  int const warp = static_cast<int>(threadIdx.x) / warp_size;
  Index sum = value;
  for (int step = 1; step < warp_size; step *= 2) {
    Index const other = __shfl_up_sync(0xffffffffu, sum, step);
    if (lane >= step) sum += other;
  }
  __syncthreads();  // until the sums of the last call are read
  if (lane == warp_size - 1) of_warp[warp] = sum;
  __syncthreads();
  total = 0;
  for (int w = 0; w < warps; ++w) {
    if (w == warp) sum += total;
    total += of_warp[w];
  }
  return sum - value;
}

/// f(i) to notes[i], and their sum over each block's part.
template <class F, class Note>
__global__ void __launch_bounds__(list_threads)
    note_values(Index n, __grid_constant__ F const f, Note* notes, Index* sums) {
  begin_after_previous_kernel();
  ListPart const part(n, list_threads);
  Index sum = 0, total = 0;
  for (std::int64_t i = part.first + threadIdx.x; i < part.last; i += list_threads) {
    Index const value = f(static_cast<Index>(i));
    notes[i] = static_cast<Note>(value);
    sum += value;
  }
  scan_block(sum, total);
  if (threadIdx.x == 0) sums[blockIdx.x] = total;
}

/// store(i, f(i), the sum over all before i) for a part of a list. before: the sum over all before the part. Returns that over
/// all before its end.
template <class F, class Store>
__device__ Index store_part(ListPart const& part, F const& f, Store const& store, Index before) {
  for (std::int64_t first = part.first; first < part.last; first += list_threads) {
    std::int64_t const i = first + threadIdx.x;
    Index const value = i < part.last ? f(static_cast<Index>(i)) : 0;
    Index total = 0;
    Index const sum = before + scan_block(value, total);
    if (i < part.last) store(static_cast<Index>(i), value, sum);
    before += total;
  }
  return before;
}

/// The same for all of a list. sums: those of parts, of which a block reads those before its own.
template <class F, class Store>
__global__ void __launch_bounds__(list_threads)
    store_sums(Index n, __grid_constant__ F const f, Store const store, Index const* sums) {
  begin_after_previous_kernel();
  Index of_parts = 0, before = 0;
  for (unsigned b = threadIdx.x; b < blockIdx.x; b += list_threads) of_parts += sums[b];
  scan_block(of_parts, before);
  Index const sum = store_part(ListPart(n, list_threads), f, store, before);
  if (blockIdx.x == gridDim.x - 1 && threadIdx.x == 0) store.total(n, sum);
}

struct StoreSums {
  Index* to;
  __device__ void operator()(Index i, Index, Index sum) const { to[i] = sum; }
  __device__ void total(Index n, Index sum) const { to[n] = sum; }
};
struct StoreNumbers {
  Index *to, *count;
  __device__ void operator()(Index i, Index is_wanted, Index sum) const {
    if (is_wanted != 0) to[sum] = i;
  }
  __device__ void total(Index, Index sum) const { *count = sum; }
};

template <class Note>
struct Noted {
  Note const* notes;
  __device__ Index operator()(Index i) const { return notes[i]; }
};
template <class F>
struct IsWanted {
  F f;
  __device__ Index operator()(Index i) const { return f(i) ? 1 : 0; }
};

template <class F, class Note, class Store>
void scan_by_notes(CudaContext const& context, char const* verb, Index n, F const& f, Note* notes,
                   Index* sums, Store const& store) {
  LaunchShape const shape{list_blocks(n, list_threads), list_threads};
  auto const stream = context.stream()->get();
  if (shape.blocks == 1)
    return launch(Start::early, verb, shape, stream, store_sums<F, Store>, n, f, store, sums);
  launch(Start::early, verb, shape, stream, note_values<F, Note>, n, f, notes, sums);
  launch(Start::early, verb, shape, stream, store_sums<Noted<Note>, Store>, n, Noted<Note>{notes},
         store, sums);
}

template <class F>
void scan_list(CudaContext& context, Index n, F const& f, Index* to) {
  auto const device = context.stream()->enter();
  auto* const sums =
      reinterpret_cast<Index*>(context.scratch().take(most_list_blocks * sizeof(Index)));
  scan_by_notes(context, "scan", n, f, to, sums, StoreSums{to});
}

template <class F>
void select_list(CudaContext& context, Index n, F const& f, Index* to, Index* count) {
  auto const device = context.stream()->enter();
  constexpr std::size_t bytes_of_sums = most_list_blocks * sizeof(Index);
  std::byte* const memory =
      context.scratch().take(bytes_of_sums + (n > short_list ? static_cast<std::size_t>(n) : 0));
  scan_by_notes(context, "select", n, IsWanted<F>{f},
                reinterpret_cast<std::uint8_t*>(memory + bytes_of_sums),
                reinterpret_cast<Index*>(memory), StoreNumbers{to, count});
}

}  // namespace pliant::detail
