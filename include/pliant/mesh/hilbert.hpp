#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
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

/// How a part of a Hilbert curve lies in the whole, and what follows for its own parts, by J. Skilling, "Programming the
/// Hilbert curve", AIP Conference Proceedings 707 (2004). There all lower bits of coordinates are inverted and exchanged;
/// this table says, for each way in which that can have been done, what another bit of each coordinate leads to.
template <std::size_t Dim>
class HilbertTable {
 public:
  static constexpr std::size_t corners = std::size_t{1} << Dim;
  struct Entry {
    std::uint8_t digit;  // of the code, Dim bits
    std::uint8_t next;   // turn of the part
  };
  /// One bit of each coordinate, the first lowest, of a part with this turn. Turn 0 is that of the whole.
  [[nodiscard]] constexpr Entry at(std::size_t turn, std::size_t bits) const {
    return entries_[turn * corners + bits];
  }

  constexpr HilbertTable() {
    std::size_t known = 1;
    for (std::size_t turn = 0; turn < known; ++turn)
      for (std::size_t bits = 0; bits < corners; ++bits) {
        auto [digit, after] = part(turns_[turn], bits);
        std::size_t next = 0;
        while (next < known && !(turns_[next] == after)) ++next;
        if (next == known) turns_[known++] = after;
        entries_[turn * corners + bits] = {digit, static_cast<std::uint8_t>(next)};
      }
  }

 private:
  /// Of which coordinate each one now has the lower bits, whether they are inverted, and whether the digits are.
  struct Turn {
    std::array<std::uint8_t, Dim> from{};
    std::array<bool, Dim> inverted{};
    bool flipped = false;
    constexpr Turn() {
      for (std::size_t k = 0; k < Dim; ++k) from[k] = static_cast<std::uint8_t>(k);
    }
    constexpr bool operator==(Turn const&) const = default;
  };
  static constexpr std::pair<std::uint8_t, Turn> part(Turn turn, std::size_t bits) {
    std::array<bool, Dim> bit{};
    for (std::size_t k = 0; k < Dim; ++k) bit[k] = (bits >> turn.from[k] & 1) != turn.inverted[k];
    for (std::size_t k = 0; k < Dim; ++k)
      if (bit[k]) {
        turn.inverted[0] = !turn.inverted[0];
      } else {
        std::swap(turn.from[0], turn.from[k]);
        std::swap(turn.inverted[0], turn.inverted[k]);
      }
    unsigned digit = 0;
    bool gray = false;
    for (std::size_t k = 0; k < Dim; ++k) {
      gray = gray != bit[k];
      digit = digit << 1 | (gray != turn.flipped ? 1u : 0u);
    }
    turn.flipped = turn.flipped != gray;
    return {static_cast<std::uint8_t>(digit), turn};
  }

  static constexpr std::size_t most = Dim == 2 ? 16 : 96;  // turns
  std::array<Turn, most> turns_{};
  std::array<Entry, most * corners> entries_{};
};

/// How far along a Hilbert curve through a grid of 2^bits cells a side one of them lies.
template <std::size_t Dim>
std::uint64_t hilbert_code(std::array<std::uint32_t, Dim> const& cell, int bits) {
  static HilbertTable<Dim> const table;  // made at run time: compilers take a second for it
  std::uint64_t code = 0;
  std::size_t turn = 0;
  for (int b = bits - 1; b >= 0; --b) {
    std::size_t corner = 0;
    for (std::size_t k = 0; k < Dim; ++k) corner |= std::size_t{cell[k] >> b & 1} << k;
    auto const [digit, next] = table.at(turn, corner);
    code = code << Dim | digit;
    turn = next;
  }
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
