#pragma once

#include <cmath>
#include <cstddef>

#include <pliant/error.hpp>
#include <pliant/mesh/mesh.hpp>

namespace pliant::detail {

/// Throws Error where a plane cell, of a hierarchy by its number, is not strictly convex and counter-clockwise.
template <Element E, class Points>
void check_convex(Index c, Connectivity<E> const& nodes, Points const& points) {
  constexpr std::size_t k = E::cell::corners;
  auto const point = [&](std::size_t i) -> auto& {
    return points[static_cast<std::size_t>(nodes[i % k])];
  };
  for (std::size_t i = 0; i < k; ++i) {
    auto const [x, y] = point(i);
    auto const [next_x, next_y] = point(i + 1);
    auto const [last_x, last_y] = point(i + k - 1);
    double const a = next_x - x, b = next_y - y, p = last_x - x, q = last_y - y;
    // A sine below 1e-12 is no angle but rounding. The comparison is false for NaN and infinity.
    if (!(a * q - b * p > 1e-12 * std::hypot(a, b) * std::hypot(p, q)))
      throw Error("Hierarchy: cell ", c, " is inverted, degenerate or not finite at its node ",
                  nodes[i], " ", point(i), "; cells must be strictly convex and counter-clockwise");
  }
}

}  // namespace pliant::detail
