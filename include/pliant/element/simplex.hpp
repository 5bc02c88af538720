#pragma once

#include <pliant/element/element.hpp>

namespace pliant {

/// The linear triangle. Nodes counter-clockwise.
struct Tri3 {
  using cell = Triangle;
  static constexpr int nodes = 3, dim = 2;
  static constexpr char const* name() { return "Tri3"; }

  PLIANT_HOST_DEVICE static constexpr Vector<double, 3> shape(Vector<double, 2> const& xi) {
    return {{{1 - xi[0] - xi[1]}, {xi[0]}, {xi[1]}}};
  }
  PLIANT_HOST_DEVICE static constexpr Matrix<double, 3, 2> gradient(Vector<double, 2> const&) {
    return {{{-1, -1}, {1, 0}, {0, 1}}};
  }
  static constexpr std::array<std::array<int, 2>, 3> sides() { return {{{0, 1}, {1, 2}, {2, 0}}}; }
  static constexpr std::array<std::array<int, 2>, 3> edges() { return sides(); }
};

/// The linear tetrahedron. Node 3 lies on the side from which 0, 1, 2 run counter-clockwise when
/// seen from it reversed: det(X₁−X₀, X₂−X₀, X₃−X₀) > 0.
struct Tet4 {
  using cell = Tetrahedron;
  static constexpr int nodes = 4, dim = 3;
  static constexpr char const* name() { return "Tet4"; }

  PLIANT_HOST_DEVICE static constexpr Vector<double, 4> shape(Vector<double, 3> const& xi) {
    return {{{1 - xi[0] - xi[1] - xi[2]}, {xi[0]}, {xi[1]}, {xi[2]}}};
  }
  PLIANT_HOST_DEVICE static constexpr Matrix<double, 4, 3> gradient(Vector<double, 3> const&) {
    return {{{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  }
  static constexpr std::array<std::array<int, 3>, 4> sides() {
    return {{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  }
  static constexpr std::array<std::array<int, 2>, 6> edges() {
    return {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  }
};

}  // namespace pliant
