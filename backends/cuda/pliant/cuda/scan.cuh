#pragma once

#include <algorithm>
#include <cstdint>

#include <pliant/cuda/context.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/tuning.hpp>

// scan and select: each block takes a part of the list, calls the function, and tells the others the sum over its part; once it
// knows what those before it have, it stores sums (Merrill, Garland, Single-pass parallel prefix scan with decoupled look-back, 2016).
namespace pliant::detail {

/// Of [0, n), for a block: whole rounds of `round`, but for the last. 64 bits: a round may pass the largest Index.
struct ListPart {
  std::int64_t first, last;
  __device__ ListPart(Index n, int round) : ListPart(n, round, blockIdx.x) {}
  /// The part of another block.
  __device__ ListPart(Index n, int round, unsigned block) {
    std::int64_t const rounds = (std::int64_t{n} + round - 1) / round;
    first = rounds * block / gridDim.x * round;
    last = min(rounds * (block + 1) / gridDim.x * round, std::int64_t{n});
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

template <class Note>
struct Noted {
  Note const* notes;
  __device__ Index operator()(Index i) const { return notes[i]; }
};
/// The sum over all parts before one, for the first warp, each thread of which gets it; waits for them. `tag`: of this launch.
__device__ inline Index sum_of_parts_before(unsigned part, unsigned long long const volatile* parts,
                                            unsigned tag) {
  auto const lane = static_cast<std::int64_t>(threadIdx.x) % warp_size;
  Index before = 0;
  for (std::int64_t last = std::int64_t{part} - 1; last >= 0; last -= warp_size) {
    std::int64_t const own = last - lane;
    unsigned long long word = 0;
    unsigned kind = PartSums::known;
    if (own >= 0) do {
        word = parts[own];
        kind = static_cast<unsigned>(word >> 32) - tag;
      } while (kind != PartSums::of_part && kind != PartSums::known);
    unsigned const are_known = __ballot_sync(0xffffffffu, kind == PartSums::known);
    int const nearest = are_known == 0 ? warp_size - 1 : __ffs(static_cast<int>(are_known)) - 1;
    auto value = own >= 0 && lane <= nearest ? static_cast<Index>(word) : 0;
    for (int step = warp_size / 2; step > 0; step /= 2)
      value += __shfl_xor_sync(0xffffffffu, value, step);
    before += value;
    if (are_known != 0) break;
  }
  return before;
}

/// store(i, f(i), the sum over all before i) for all of a list. Blocks take parts in the order in which they start, so that those that
/// one waits for have started. `notes`: room for what f gives.
template <class F, class Note, class Store>
__global__ void __launch_bounds__(list_threads)
    scan_parts(Index n, __grid_constant__ F const f, Note* notes, Store const store,
               PartSums* sums) {
  begin_after_previous_kernel();
  __shared__ unsigned own_part, own_tag;
  __shared__ Index before_part;
  if (threadIdx.x == 0) {
    own_tag = sums->next_tag;
    own_part = atomicAdd(&sums->started, 1u);
  }
  __syncthreads();
  unsigned const number = own_part, tag = own_tag;
  ListPart const part(n, list_threads, number);
  bool const is_one_round = part.last - part.first <= list_threads;
  Index value = 0, of_thread = 0, total = 0;
  for (std::int64_t i = part.first + threadIdx.x; i < part.last; i += list_threads) {
    value = f(static_cast<Index>(i));
    if (!is_one_round) notes[i] = static_cast<Note>(value);
    of_thread += value;
  }
  Index const sum = scan_block(of_thread, total);
  auto const tell = [&](unsigned kind, Index known) {
    atomicExch(&sums->parts[number],
               static_cast<unsigned long long>(tag + kind) << 32 | static_cast<unsigned>(known));
  };
  if (threadIdx.x < warp_size) {
    Index before = 0;
    if (number > 0) {
      if (threadIdx.x == 0) tell(PartSums::of_part, total);
      before = sum_of_parts_before(number, sums->parts, tag);
    }
    if (threadIdx.x == 0) {
      tell(PartSums::known, before + total);
      before_part = before;
    }
  }
  __syncthreads();
  Index const before = before_part;
  if (!is_one_round)
    store_part(part, Noted<Note>{notes}, store, before);
  else if (part.first + threadIdx.x < part.last)
    store(static_cast<Index>(part.first + threadIdx.x), value, before + sum);
  if (threadIdx.x != 0) return;
  if (number == gridDim.x - 1) store.total(n, before + total);
  if (atomicAdd(&sums->ended, 1u) < gridDim.x - 1) return;
  sums->started = sums->ended = 0;
  sums->next_tag = tag + PartSums::kinds;
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

template <class F>
struct IsWanted {
  F f;
  __device__ Index operator()(Index i) const { return f(i) ? 1 : 0; }
};

template <class F, class Note, class Store>
void scan_by_parts(CudaContext& context, char const* verb, Index n, F const& f, Note* notes,
                   Store const& store) {
  Index const blocks = std::clamp<Index>((n - 1) / list_threads + 1, 1, most_list_blocks);
  launch(Start::early, verb, {blocks, list_threads}, context.stream()->get(),
         scan_parts<F, Note, Store>, n, f, notes, store, context.part_sums());
}

template <class F>
void scan_list(CudaContext& context, Index n, F const& f, Index* to) {
  auto const device = context.stream()->enter();
  scan_by_parts(context, "scan", n, f, to, StoreSums{to});
}

template <class F>
void select_list(CudaContext& context, Index n, F const& f, Index* to, Index* count) {
  auto const device = context.stream()->enter();
  auto* const notes =
      reinterpret_cast<std::uint8_t*>(context.scratch().take(static_cast<std::size_t>(n)));
  scan_by_parts(context, "select", n, IsWanted<F>{f}, notes, StoreNumbers{to, count});
}

}  // namespace pliant::detail
