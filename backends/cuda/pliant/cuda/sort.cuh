#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <pliant/cuda/context.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/scan.cuh>
#include <pliant/cuda/tuning.hpp>

// sort: by one digit after the other, from the lowest on. Each block takes a part of the keys, counts how many have which digit,
// and moves them to behind those of lower digits, and those of the same digit in parts before. A thread has the
// counts of the digit of its number.
namespace pliant::detail {

template <class Key, class Value>
struct KeyList {
  Key* keys;
  Value* values;
};

inline constexpr int digit_bits = 8, digits = 1 << digit_bits;
static_assert(digits == list_threads);
/// Keys that a block moves at once.
inline constexpr int sort_round = list_threads * sort_keys;

template <class Key>
__device__ int digit_of(Key key, int shift) {
  return static_cast<int>(key >> shift & (digits - 1));
}

/// How many keys of a part have the thread's digit.
template <class Key>
__device__ Index count_digits(ListPart const& part, Key const* keys, int shift) {
  __shared__ Index counts[digits];
  counts[threadIdx.x] = 0;
  __syncthreads();
  for (std::int64_t i = part.first + threadIdx.x; i < part.last; i += list_threads)
    atomicAdd(counts + digit_of(keys[i], shift), 1);
  __syncthreads();
  return counts[threadIdx.x];
}

/// Moves the keys of a part in their order. place: where those of the thread's digit begin.
template <class List>
__device__ void move_keys(ListPart const& part, List const& from, List const& to, int shift,
                          Index place) {
  constexpr int warps = list_threads / warp_size;
  constexpr unsigned all = 0xffffffffu;
  __shared__ Index places[warps][digits];
  int const thread = static_cast<int>(threadIdx.x);
  int const lane = thread % warp_size;
  Index* const of_warp = places[thread / warp_size];
  for (std::int64_t first = part.first; first < part.last; first += sort_round) {
    for (int w = 0; w < warps; ++w) places[w][thread] = 0;
    __syncthreads();
    // Each warp takes consecutive keys, and tells for each how many of its digit it has had.
    std::int64_t const own = first + thread / warp_size * (warp_size * sort_keys) + lane;
    int digit[sort_keys];
    Index rank[sort_keys];
#pragma unroll
    for (int k = 0; k < sort_keys; ++k) {
      std::int64_t const i = own + k * warp_size;
      digit[k] = i < part.last ? digit_of(from.keys[i], shift) : digits;
      unsigned const alike = __match_any_sync(all, digit[k]);
      unsigned const before = alike & ((1u << lane) - 1);
      Index const had = digit[k] < digits ? of_warp[digit[k]] : 0;
      __syncwarp();
      if (before == 0 && digit[k] < digits) of_warp[digit[k]] = had + __popc(alike);
      __syncwarp();
      rank[k] = had + __popc(before);
    }
    __syncthreads();
    // From how many keys of a digit a warp has to where they begin.
    for (int w = 0; w < warps; ++w) {
      Index const count = places[w][thread];
      places[w][thread] = place;
      place += count;
    }
    __syncthreads();
#pragma unroll
    for (int k = 0; k < sort_keys; ++k) {
      if (digit[k] == digits) continue;
      std::int64_t const i = own + k * warp_size;
      Index const at = of_warp[digit[k]] + rank[k];
      to.keys[at] = from.keys[i];
      to.values[at] = from.values[i];
    }
    __syncthreads();  // until all places are read
  }
}

/// counts: (digits, blocks).
template <class Key>
__global__ void __launch_bounds__(list_threads)
    count_keys(Index n, Key const* keys, int shift, Index* counts) {
  begin_after_previous_kernel();
  Index const count = count_digits(ListPart(n, sort_round), keys, shift);
  counts[threadIdx.x * gridDim.x + blockIdx.x] = count;
}

/// A block for each digit: from counts of parts to how many there are in the parts before. totals: (digits).
template <class Count>
__global__ void __launch_bounds__(list_threads)
    scan_counts(int parts, Count* counts, Count* totals) {
  begin_after_previous_kernel();
  Count* const of_digit = counts + static_cast<std::ptrdiff_t>(blockIdx.x) * parts;
  Count before = 0;
  for (int first = 0; first < parts; first += list_threads) {
    int const p = first + static_cast<int>(threadIdx.x);
    Count total = 0;
    Count const sum = scan_block(p < parts ? of_digit[p] : 0, total);
    if (p < parts) of_digit[p] = before + sum;
    before += total;
  }
  if (threadIdx.x == 0) totals[blockIdx.x] = before;
}

template <class List>
__global__ void __launch_bounds__(list_threads)
    move_by_digit(Index n, List const from, List const to, int shift, Index const* counts,
                  Index const* totals) {
  begin_after_previous_kernel();
  Index total = 0;
  Index const place =
      scan_block(totals[threadIdx.x], total) + counts[threadIdx.x * gridDim.x + blockIdx.x];
  move_keys(ListPart(n, sort_round), from, to, shift, place);
}

template <class List>
__device__ void copy_keys(ListPart const& part, List const& from, List const& to) {
  for (std::int64_t i = part.first + threadIdx.x; i < part.last; i += list_threads) {
    to.keys[i] = from.keys[i];
    to.values[i] = from.values[i];
  }
}
template <class List>
__global__ void __launch_bounds__(list_threads) copy_list(Index n, List const from, List const to) {
  begin_after_previous_kernel();
  copy_keys(ListPart(n, list_threads), from, to);
}

/// All digits of a short list, by one block.
template <class List>
__device__ void sort_all(Index n, List const& list, List const& other, int bits) {
  ListPart const part(n);
  List from = list, to = other;
  for (int shift = 0; shift < bits; shift += digit_bits) {
    Index const count = count_digits(part, from.keys, shift);
    if (__syncthreads_or(count == n) != 0) continue;  // keys are alike there
    Index total = 0;
    move_keys(part, from, to, shift, scan_block(count, total));
    List const moved = to;
    to = from;
    from = moved;
  }
  if (from.keys != list.keys) copy_keys(part, from, list);
}
template <class List>
__global__ void __launch_bounds__(list_threads)
    sort_in_block(Index n, List const list, List const other, int bits) {
  begin_after_previous_kernel();
  sort_all(n, list, other, bits);
}

/// The same by a cluster of blocks, each of which has a part. counts: (digits, blocks).
template <class List>
__global__ void __launch_bounds__(list_threads)
    sort_in_cluster(Index n, List const list, List const other, int bits, Index* counts) {
  begin_after_previous_kernel();
  ListPart const part(n, list_threads);
  Index* const of_digit = counts + threadIdx.x * gridDim.x;
  List from = list, to = other;
  for (int shift = 0; shift < bits; shift += digit_bits) {
    of_digit[blockIdx.x] = count_digits(part, from.keys, shift);
    wait_for_cluster();
    Index before = 0, of_all = 0, total = 0;
    for (unsigned b = 0; b < gridDim.x; ++b) {
      Index const count = of_digit[b];
      before += b < blockIdx.x ? count : 0;
      of_all += count;
    }
    bool const are_alike = __syncthreads_or(of_all == n) != 0;  // keys, there
    if (!are_alike) move_keys(part, from, to, shift, scan_block(of_all, total) + before);
    wait_for_cluster();  // until all keys are there, and counts are read
    if (are_alike) continue;
    List const moved = to;
    to = from;
    from = moved;
  }
  if (from.keys != list.keys) copy_keys(part, from, list);
}

template <class Key, class Value>
void sort_list(CudaContext& context, Index n, KeyList<Key, Value> const& list, int bits) {
  using List = KeyList<Key, Value>;
  auto const device = context.stream()->enter();
  auto const stream = context.stream()->get();
  LaunchShape const shape{list_blocks(n, sort_round), list_threads};
  auto const size = static_cast<std::size_t>(n);
  auto const parts = static_cast<std::size_t>(std::max(shape.blocks, Index{step_cluster}));
  std::byte* const memory = context.scratch().take(size * (sizeof(Key) + sizeof(Value)) +
                                                   digits * (parts + 1) * sizeof(Index));
  auto* const keys = reinterpret_cast<Key*>(memory);
  List const other{keys, reinterpret_cast<Value*>(keys + size)};
  auto* const totals = reinterpret_cast<Index*>(other.values + size);
  Index* const counts = totals + digits;
  if (n > list_threads && n <= most_cluster_keys) {
    auto* const kernel = sort_in_cluster<List>;
    static bool const can_be_cluster =
        clusters_can_be_launched(reinterpret_cast<void const*>(kernel), context.stream()->device());
    if (can_be_cluster)
      return launch(Start::early, "sort", {step_cluster, list_threads, 0, step_cluster}, stream,
                    kernel, n, list, other, bits, counts);
  }
  if (shape.blocks == 1)
    return launch(Start::early, "sort", shape, stream, sort_in_block<List>, n, list, other, bits);
  List from = list, to = other;
  for (int shift = 0; shift < bits; shift += digit_bits) {
    launch(Start::early, "sort", shape, stream, count_keys<Key>, n, from.keys, shift, counts);
    launch(Start::early, "sort", {digits, list_threads}, stream, scan_counts<Index>, shape.blocks,
           counts, totals);
    launch(Start::early, "sort", shape, stream, move_by_digit<List>, n, from, to, shift, counts,
           totals);
    std::swap(from, to);
  }
  if (from.keys != list.keys)
    launch(Start::early, "sort", shape, stream, copy_list<List>, n, from, list);
}

}  // namespace pliant::detail
