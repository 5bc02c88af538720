#pragma once

#include <cstdint>
#include <cstring>

#include <pliant/config.hpp>

namespace pliant::detail {

/// Tetrahedra around a common edge, each sharing a face with the one before, in the order in which they follow each
/// other from there: one thread works on them.
inline constexpr int most_fan_elements = 6;

/// A tetrahedron and one of its edges.
struct FanMember {
  std::uint16_t bits;

  PLIANT_HOST_DEVICE static FanMember of(int element, int edge) {
    return {static_cast<std::uint16_t>(element << 3 | edge)};
  }
  PLIANT_HOST_DEVICE int element() const { return bits >> 3; }
  PLIANT_HOST_DEVICE int edge() const { return bits & 7; }

  /// Of the element's corners, of which local[4 · elements] has the numbers, eight bytes of an element read at once: both ends of
  /// the edge, the lower first, then the others, in an even permutation of the element's order.
  PLIANT_HOST_DEVICE int corner(std::uint16_t const* local, int k) const {
    // 0123 0231 0312 1203 1320 2301, two bits each, the first of a row lowest
    constexpr std::uint64_t corners = 0x4e'2d'c9'9c'78'e4;
    std::uint64_t own;
    std::memcpy(&own, __builtin_assume_aligned(local + 4 * element(), sizeof own), sizeof own);
    auto const at = [&](int j) {
      return static_cast<int>(own >> 16 * (corners >> (8 * edge() + 2 * j) & 3) & 0xffff);
    };
    return at(at(0) > at(1) ? k ^ 1 : k);
  }
};

}  // namespace pliant::detail
