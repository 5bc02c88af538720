#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <pliant/config.hpp>

namespace pliant::detail {

/// The numbers of a list, each once, ascending.
inline std::vector<Index> each_once(std::vector<Index> list) {
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}
/// The same where all are in [0, end): long lists by a bit for each number.
inline std::vector<Index> each_once(std::vector<Index> list, std::size_t end) {
  if (8 * list.size() < end / 64) return each_once(std::move(list));
  std::vector<std::uint64_t> bits((end + 63) / 64);
  for (Index const i : list)
    bits[static_cast<std::size_t>(i) / 64] |= std::uint64_t{1}
                                              << (static_cast<std::size_t>(i) % 64);
  auto next = list.begin();
  for (std::size_t word = 0; word < bits.size(); ++word)
    for (auto left = bits[word]; left != 0; left &= left - 1)
      *next++ = static_cast<Index>(64 * word) + std::countr_zero(left);
  list.erase(next, list.end());
  return list;
}

}  // namespace pliant::detail
