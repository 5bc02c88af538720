#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include <pliant/math/group_by_key.hpp>
#include <pliant/mesh/mesh.hpp>

namespace pliant {

namespace detail {
/// The positions of codes from the smallest to the largest, of equal ones in their order: a radix sort.
inline std::vector<Index> ascending(std::vector<std::uint64_t> const& codes) {
  constexpr int digit = 11;  // bits
  std::vector<Index> order(codes.size()), before, keys(codes.size());
  std::iota(order.begin(), order.end(), 0);
  for (int shift = 0; shift < 64; shift += digit) {
    for (std::size_t i = 0; i < order.size(); ++i)
      keys[i] = static_cast<Index>(codes[static_cast<std::size_t>(order[i])] >> shift &
                                   ((1u << digit) - 1));
    before.swap(order);
    order = group_by_key(keys, 1 << digit).order;
    for (Index& i : order) i = before[static_cast<std::size_t>(i)];
  }
  return order;
}

/// How far along a Hilbert curve through a grid of 2^bits cells a side one of them lies, by J. Skilling,
/// "Programming the Hilbert curve", AIP Conference Proceedings 707 (2004).
template <std::size_t Dim>
std::uint64_t hilbert_code(std::array<std::uint32_t, Dim> cell, int bits) {
  std::uint32_t const highest = std::uint32_t{1} << (bits - 1);
  // Each part of the curve turns as it lies in the whole.
  for (std::uint32_t bit = highest; bit > 1; bit >>= 1) {
    std::uint32_t const below = bit - 1;
    for (std::uint32_t& x : cell) {
      std::uint32_t const swapped = (x & bit) != 0 ? 0 : (cell[0] ^ x) & below;
      cell[0] ^= (x & bit) != 0 ? below : swapped;
      x ^= swapped;
    }
  }
  for (std::size_t k = 1; k < Dim; ++k) cell[k] ^= cell[k - 1];
  std::uint32_t flipped = 0;
  for (std::uint32_t bit = highest; bit > 1; bit >>= 1)
    if ((cell[Dim - 1] & bit) != 0) flipped ^= bit - 1;
  std::uint64_t code = 0;
  for (int b = bits - 1; b >= 0; --b)
    for (std::uint32_t const x : cell) code = code << 1 | ((x ^ flipped) >> b & 1);
  return code;
}
}  // namespace detail

/// The order of points along a Hilbert curve through their bounding box: neighbours in space become
/// neighbours in memory, and any stretch of the curve fills a region that hangs together. Points of one code
/// keep their order.
template <std::size_t Dim>
std::vector<Index> hilbert_order(std::span<std::array<double, Dim> const> points) {
  constexpr int bits = 63 / Dim < 31 ? 63 / Dim : 31;
  std::array<double, Dim> low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (auto const& p : points)
    for (std::size_t k = 0; k < Dim; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  double extent = 0;
  for (std::size_t k = 0; k < Dim; ++k) extent = std::max(extent, high[k] - low[k]);
  double const scale =
      extent > 0 ? static_cast<double>((std::uint32_t{1} << bits) - 1) / extent : 0.0;

  std::vector<std::uint64_t> codes;
  codes.reserve(points.size());
  for (auto const& p : points) {
    std::array<std::uint32_t, Dim> cell;
    for (std::size_t k = 0; k < Dim; ++k)
      cell[k] = static_cast<std::uint32_t>((p[k] - low[k]) * scale);
    codes.push_back(detail::hilbert_code(cell, bits));
  }
  return detail::ascending(codes);
}

}  // namespace pliant
