#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <pliant/math/group_by_key.hpp>
#include <pliant/mesh/bounding_box.hpp>

namespace pliant {

namespace detail {
/// A list of numbers, in the order of their bits from 31 on, of those with the same ones as they stand: a radix sort.
inline void sort_by_high_bits(std::unique_ptr<std::uint64_t[]>& list, Index n) {
  constexpr int digit = 11;  // bits
  auto sorted = std::make_unique_for_overwrite<std::uint64_t[]>(static_cast<std::size_t>(n));
  for (int shift = 31; shift < 64; shift += digit) {
    auto const digit_of = [&](Index i) {
      return list[static_cast<std::size_t>(i)] >> shift & ((std::uint64_t{1} << digit) - 1);
    };
    distribute(
        n, Index{1} << digit,
        [&](Index from, Index to, Index* numbers) {
          for (Index i = from; i < to; ++i) ++numbers[digit_of(i)];
        },
        [&](Index from, Index to, Index* places) {
          for (Index i = from; i < to; ++i)
            sorted[static_cast<std::size_t>(places[digit_of(i)]++)] =
                list[static_cast<std::size_t>(i)];
        });
    list.swap(sorted);
  }
}

/// The positions 0 to n − 1 from the smallest code(i) to the largest, of equal ones in their order. leading(i), of 33 bits
/// at most, is the highest bits of the code, which tell nearly all apart.
template <class Leading, class Code>
std::vector<Index> ascending(Index n, Leading const& leading, Code const& code) {
  auto list = std::make_unique_for_overwrite<std::uint64_t[]>(static_cast<std::size_t>(n));
  for_each_on_host(n, 4096, [&](Index i) {
    list[static_cast<std::size_t>(i)] = leading(i) << 31 | static_cast<std::uint64_t>(i);
  });
  sort_by_high_bits(list, n);
  std::vector<Index> order(static_cast<std::size_t>(n));
  for_each_on_host(n, 16384, [&](Index k) {
    order[static_cast<std::size_t>(k)] =
        static_cast<Index>(list[static_cast<std::size_t>(k)] & 0x7fffffff);
  });
  auto const in_one_run = [&](Index k) {
    return (list[static_cast<std::size_t>(k)] ^ list[static_cast<std::size_t>(k) - 1]) >> 31 == 0;
  };
  HostParts{n}([&](Index first, Index last, int) {
    std::vector<std::pair<std::uint64_t, Index>> run;  // with the same leading bits
    for (Index k = first; k < last; ++k) {
      if (k + 1 == n || !in_one_run(k + 1) || (k > 0 && in_one_run(k))) continue;
      run.clear();
      for (Index j = k; j == k || (j < n && in_one_run(j)); ++j)
        run.emplace_back(code(order[static_cast<std::size_t>(j)]),
                         order[static_cast<std::size_t>(j)]);
      std::sort(run.begin(), run.end());
      for (std::size_t j = 0; j < run.size(); ++j)
        order[static_cast<std::size_t>(k) + j] = run[j].second;
    }
  });
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
  constexpr int bits = 63 / Dim < 31 ? 63 / Dim : 31, leading_bits = 33 / Dim;
  BoundingBox<Dim> const box(points);
  double extent = 0;
  for (std::size_t k = 0; k < Dim; ++k) extent = std::max(extent, box.high[k] - box.low[k]);
  double const scale =
      extent > 0 ? static_cast<double>((std::uint32_t{1} << bits) - 1) / extent : 0.0;
  auto const code = [&](Index i, int of_bits) {
    std::array<std::uint32_t, Dim> cell;
    for (std::size_t k = 0; k < Dim; ++k)
      cell[k] = static_cast<std::uint32_t>((points[static_cast<std::size_t>(i)][k] - box.low[k]) *
                                           scale) >>
                (bits - of_bits);
    return detail::hilbert_code(cell, of_bits);
  };
  return detail::ascending(
      static_cast<Index>(points.size()), [&](Index i) { return code(i, leading_bits); },
      [&](Index i) { return code(i, bits); });
}

}  // namespace pliant
