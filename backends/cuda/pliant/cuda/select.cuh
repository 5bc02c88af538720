#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/tuning.hpp>

namespace pliant::detail {

constexpr std::size_t selected_words(Index n) {
  return (static_cast<std::size_t>(n) + warp_size - 1) / warp_size;
}

/// Bit i % 32 of word i / 32: whether f(i).
template <class F>
__global__ void __launch_bounds__(node_threads)
    mark_selected(Index n, __grid_constant__ F const f, std::uint32_t* words) {
  begin_after_previous_kernel();
  std::int64_t const i = std::int64_t{blockIdx.x} * node_threads + threadIdx.x;
  unsigned const word = __ballot_sync(0xffffffffu, i < n && f(static_cast<Index>(i)));
  if (i < n && i % warp_size == 0) words[i / warp_size] = word;
}

/// The numbers of the bits that are set, ascending.
inline std::vector<Index> numbers_of_bits(std::vector<std::uint32_t> const& words) {
  std::vector<Index> numbers;
  for (std::size_t w = 0; w < words.size(); ++w)
    for (std::uint32_t word = words[w]; word != 0; word &= word - 1)
      numbers.push_back(static_cast<Index>(w * warp_size) + std::countr_zero(word));
  return numbers;
}

}  // namespace pliant::detail
