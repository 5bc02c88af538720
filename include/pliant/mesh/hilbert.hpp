#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <pliant/mesh/mesh.hpp>

namespace pliant {

namespace detail {
/// A code and its position in a list.
struct CodeAt {
  std::uint64_t code;
  Index position;
};

/// Orders codes by their bits from `from` up to `to`, those with the same ones as they stand: a radix sort.
inline void sort_by_bits(std::vector<CodeAt>& codes, int from, int to) {
  constexpr int digit = 11;  // bits
  std::vector<CodeAt> sorted(codes.size());
  for (int shift = from; shift < to; shift += digit) {
    auto const key = [shift](CodeAt const& c) {
      return static_cast<std::size_t>(c.code >> shift & ((1u << digit) - 1));
    };
    std::array<Index, std::size_t{1} << digit> next{};
    for (CodeAt const& c : codes) ++next[key(c)];
    for (Index before = 0; Index & first : next) before += std::exchange(first, before);
    for (CodeAt const& c : codes) sorted[static_cast<std::size_t>(next[key(c)]++)] = c;
    codes.swap(sorted);
  }
}

/// The positions of codes of `width` bits from the smallest to the largest, of equal ones in their order.
inline std::vector<Index> ascending(std::vector<std::uint64_t> const& codes, int width) {
  std::vector<CodeAt> list(codes.size());
  for (std::size_t i = 0; i < codes.size(); ++i) list[i] = {codes[i], static_cast<Index>(i)};
  // The leading bits tell nearly all apart; of the few that they do not, each goes before those that are larger.
  constexpr int leading = 33;
  int const low = std::max(0, width - leading);
  sort_by_bits(list, low, width);
  constexpr std::size_t few = 64;
  std::size_t run = 0;  // where those with the same leading bits begin
  for (std::size_t i = 1; i < list.size(); ++i) {
    if (list[i].code >> low != list[run].code >> low) run = i;
    if (i - run > few) {
      sort_by_bits(list, 0, width);
      break;
    }
    for (std::size_t k = i; k > run && list[k].code < list[k - 1].code; --k)
      std::swap(list[k], list[k - 1]);
  }
  std::vector<Index> order(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) order[i] = list[i].position;
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
  return detail::ascending(codes, bits * int{Dim});
}

}  // namespace pliant
