#pragma once

#include <array>
#include <concepts>

#include <pliant/math/matrix.hpp>

// The reference shapes: where corners lie, which of them make up sides and edges, and the functions
// that are one at a corner and zero at the others. Sides list their corners counter-clockwise seen
// from outside; behind a triangle's three stands −1.
namespace pliant {

/// [−1, 1]: the side of a plane cell.
struct Segment {
  static constexpr int dim = 1, corners = 2;
  static constexpr double volume = 2;

  PLIANT_HOST_DEVICE static constexpr Vector<double, 1> corner(int a) {
    return {{{a == 1 ? 1.0 : -1.0}}};
  }
  template <class S>
  PLIANT_HOST_DEVICE static constexpr Vector<S, 2> linear(Vector<S, 1> const& xi) {
    return {{{(1 - xi[0]) / 2}, {(1 + xi[0]) / 2}}};
  }
  static constexpr std::array<std::array<int, 1>, 2> sides() { return {{{0}, {1}}}; }
  static constexpr std::array<std::array<int, 2>, 1> edges() { return {{{0, 1}}}; }
};

/// Corners (0, 0), (1, 0), (0, 1).
struct Triangle {
  static constexpr int dim = 2, corners = 3;
  static constexpr double volume = 1.0 / 2;

  PLIANT_HOST_DEVICE static constexpr Vector<double, 2> corner(int a) {
    return {{{a == 1 ? 1.0 : 0.0}, {a == 2 ? 1.0 : 0.0}}};
  }
  template <class S>
  PLIANT_HOST_DEVICE static constexpr Vector<S, 3> linear(Vector<S, 2> const& xi) {
    return {{{S(1) - xi[0] - xi[1]}, {xi[0]}, {xi[1]}}};
  }
  static constexpr std::array<std::array<int, 2>, 3> sides() { return {{{0, 1}, {1, 2}, {2, 0}}}; }
  static constexpr std::array<std::array<int, 2>, 3> edges() { return sides(); }
};

/// Corners counter-clockwise from (−1, −1) on [−1, 1]².
struct Quadrilateral {
  static constexpr int dim = 2, corners = 4;
  static constexpr double volume = 4;

  PLIANT_HOST_DEVICE static constexpr Vector<double, 2> corner(int a) {
    return {{{a == 1 || a == 2 ? 1.0 : -1.0}, {a >= 2 ? 1.0 : -1.0}}};
  }
  template <class S>
  PLIANT_HOST_DEVICE static constexpr Vector<S, 4> linear(Vector<S, 2> const& xi) {
    Vector<S, 4> n{};
    for (int a = 0; a < 4; ++a) n[a] = (1 + corner(a)[0] * xi[0]) * (1 + corner(a)[1] * xi[1]) / 4;
    return n;
  }
  static constexpr std::array<std::array<int, 2>, 4> sides() {
    return {{{0, 1}, {1, 2}, {2, 3}, {3, 0}}};
  }
  static constexpr std::array<std::array<int, 2>, 4> edges() { return sides(); }
};

/// Corners 0 and the unit vectors: det(X₁−X₀, X₂−X₀, X₃−X₀) > 0.
struct Tetrahedron {
  static constexpr int dim = 3, corners = 4;
  static constexpr double volume = 1.0 / 6;

  PLIANT_HOST_DEVICE static constexpr Vector<double, 3> corner(int a) {
    return {{{a == 1 ? 1.0 : 0.0}, {a == 2 ? 1.0 : 0.0}, {a == 3 ? 1.0 : 0.0}}};
  }
  template <class S>
  PLIANT_HOST_DEVICE static constexpr Vector<S, 4> linear(Vector<S, 3> const& xi) {
    return {{{S(1) - xi[0] - xi[1] - xi[2]}, {xi[0]}, {xi[1]}, {xi[2]}}};
  }
  static constexpr std::array<std::array<int, 3>, 4> sides() {
    return {{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  }
  static constexpr std::array<std::array<int, 2>, 6> edges() {
    return {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  }
};

/// [−1, 1]³: corners 0-3 counter-clockwise at ξ₂ = −1, 4-7 above them.
struct Hexahedron {
  static constexpr int dim = 3, corners = 8;
  static constexpr double volume = 8;

  PLIANT_HOST_DEVICE static constexpr Vector<double, 3> corner(int a) {
    auto const below = Quadrilateral::corner(a % 4);
    return {{{below[0]}, {below[1]}, {a >= 4 ? 1.0 : -1.0}}};
  }
  template <class S>
  PLIANT_HOST_DEVICE static constexpr Vector<S, 8> linear(Vector<S, 3> const& xi) {
    Vector<S, 8> n{};
    for (int a = 0; a < 8; ++a) {
      auto const x = corner(a);
      n[a] = (1 + x[0] * xi[0]) * (1 + x[1] * xi[1]) * (1 + x[2] * xi[2]) / 8;
    }
    return n;
  }
  static constexpr std::array<std::array<int, 4>, 6> sides() {
    return {{{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
  }
  static constexpr std::array<std::array<int, 2>, 12> edges() {
    return {{{0, 1},
             {1, 2},
             {2, 3},
             {3, 0},
             {4, 5},
             {5, 6},
             {6, 7},
             {7, 4},
             {0, 4},
             {1, 5},
             {2, 6},
             {3, 7}}};
  }
};

/// Triangle × [−1, 1]: corners 0-2 of the triangle at ξ₂ = −1, 3-5 above them.
struct Wedge {
  static constexpr int dim = 3, corners = 6;
  static constexpr double volume = 1;

  PLIANT_HOST_DEVICE static constexpr Vector<double, 3> corner(int a) {
    auto const below = Triangle::corner(a % 3);
    return {{{below[0]}, {below[1]}, {a >= 3 ? 1.0 : -1.0}}};
  }
  template <class S>
  PLIANT_HOST_DEVICE static constexpr Vector<S, 6> linear(Vector<S, 3> const& xi) {
    auto const t = Triangle::linear(Vector<S, 2>{{{xi[0]}, {xi[1]}}});
    Vector<S, 6> n{};
    for (int a = 0; a < 6; ++a) n[a] = t[a % 3] * (1 + corner(a)[2] * xi[2]) / 2;
    return n;
  }
  static constexpr std::array<std::array<int, 4>, 5> sides() {
    return {{{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
  }
  static constexpr std::array<std::array<int, 2>, 9> edges() {
    return {{{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}};
  }
};

/// Corners 0-3 counter-clockwise on [−1, 1]² at ξ₂ = 0, and the apex (0, 0, 1).
struct Pyramid {
  static constexpr int dim = 3, corners = 5;
  static constexpr double volume = 4.0 / 3;

  PLIANT_HOST_DEVICE static constexpr Vector<double, 3> corner(int a) {
    if (a == 4) return {{{0.0}, {0.0}, {1.0}}};
    auto const base = Quadrilateral::corner(a);
    return {{{base[0]}, {base[1]}, {0.0}}};
  }
  /// Rational (Bedrosian 1992): linear along the edges, bilinear on the base. At the apex the limit
  /// along the axis.
  template <class S>
  PLIANT_HOST_DEVICE static constexpr Vector<S, 5> linear(Vector<S, 3> const& xi) {
    S const left = S(1) - xi[2];
    S const apart = select(left < S(1e-30), S(1), left);
    Vector<S, 5> n{};
    for (int a = 0; a < 4; ++a)
      n[a] = (left + corner(a)[0] * xi[0]) * (left + corner(a)[1] * xi[1]) / (4 * apart);
    n[4] = xi[2];
    return n;
  }
  static constexpr std::array<std::array<int, 4>, 5> sides() {
    return {{{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};
  }
  static constexpr std::array<std::array<int, 2>, 8> edges() {
    return {{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}}};
  }
};

/// Barycentric coordinates are linear on it.
template <class C>
concept SimplexCell = std::same_as<C, Triangle> || std::same_as<C, Tetrahedron>;
/// [−1, 1]ᵈ.
template <class C>
concept TensorCell =
    std::same_as<C, Segment> || std::same_as<C, Quadrilateral> || std::same_as<C, Hexahedron>;

}  // namespace pliant
