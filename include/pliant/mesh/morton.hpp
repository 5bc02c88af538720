#pragma once

#include <algorithm>
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
}  // namespace detail

/// The order of points along a Morton (Z) curve through their bounding box: neighbours in space
/// become neighbours in memory. Equal codes keep their order.
template <std::size_t Dim>
std::vector<Index> morton_order(std::span<std::array<double, Dim> const> points) {
  constexpr int bits = 63 / Dim;
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
      extent > 0 ? static_cast<double>((std::uint64_t{1} << bits) - 1) / extent : 0.0;

  std::vector<std::uint64_t> codes;
  codes.reserve(points.size());
  for (auto const& p : points) {
    std::uint64_t code = 0;
    std::array<std::uint64_t, Dim> cell;
    for (std::size_t k = 0; k < Dim; ++k)
      cell[k] = static_cast<std::uint64_t>((p[k] - low[k]) * scale);
    for (int b = bits - 1; b >= 0; --b)
      for (std::size_t k = Dim; k-- > 0;) code = code << 1 | (cell[k] >> b & 1);
    codes.push_back(code);
  }
  return detail::ascending(codes);
}

}  // namespace pliant
