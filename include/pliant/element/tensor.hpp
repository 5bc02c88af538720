#pragma once

#include <pliant/element/element.hpp>

namespace pliant {

/// The bilinear quadrilateral. Nodes counter-clockwise from (−1, −1).
struct Quad4 {
  using cell = Quadrilateral;
  static constexpr int nodes = 4, dim = 2;
  static constexpr char const* name() { return "Quad4"; }

  PLIANT_HOST_DEVICE static constexpr Vector<double, 4> shape(Vector<double, 2> const& xi) {
    Vector<double, 4> n;
    for (int a = 0; a < 4; ++a) n[a] = (1 + sign(a, 0) * xi[0]) * (1 + sign(a, 1) * xi[1]) / 4;
    return n;
  }
  PLIANT_HOST_DEVICE static constexpr Matrix<double, 4, 2> gradient(Vector<double, 2> const& xi) {
    Matrix<double, 4, 2> g;
    for (int a = 0; a < 4; ++a) {
      g(a, 0) = sign(a, 0) * (1 + sign(a, 1) * xi[1]) / 4;
      g(a, 1) = sign(a, 1) * (1 + sign(a, 0) * xi[0]) / 4;
    }
    return g;
  }
  static constexpr std::array<std::array<int, 2>, 4> sides() {
    return {{{0, 1}, {1, 2}, {2, 3}, {3, 0}}};
  }
  static constexpr std::array<std::array<int, 2>, 4> edges() { return sides(); }

  /// Node a lies at ξ = (sign(a, 0), sign(a, 1)).
  PLIANT_HOST_DEVICE static constexpr int sign(int a, int k) {
    return k == 0 ? (a == 1 || a == 2 ? 1 : -1) : (a >= 2 ? 1 : -1);
  }
};

/// The trilinear hexahedron. Nodes 0-3 counter-clockwise at ξ₂ = −1, nodes 4-7 above them.
struct Hex8 {
  using cell = Hexahedron;
  static constexpr int nodes = 8, dim = 3;
  static constexpr char const* name() { return "Hex8"; }

  PLIANT_HOST_DEVICE static constexpr Vector<double, 8> shape(Vector<double, 3> const& xi) {
    Vector<double, 8> n;
    for (int a = 0; a < 8; ++a) n[a] = factor(a, 0, xi) * factor(a, 1, xi) * factor(a, 2, xi) / 8;
    return n;
  }
  PLIANT_HOST_DEVICE static constexpr Matrix<double, 8, 3> gradient(Vector<double, 3> const& xi) {
    Matrix<double, 8, 3> g;
    for (int a = 0; a < 8; ++a) {
      g(a, 0) = sign(a, 0) * factor(a, 1, xi) * factor(a, 2, xi) / 8;
      g(a, 1) = sign(a, 1) * factor(a, 0, xi) * factor(a, 2, xi) / 8;
      g(a, 2) = sign(a, 2) * factor(a, 0, xi) * factor(a, 1, xi) / 8;
    }
    return g;
  }
  static constexpr std::array<std::array<int, 4>, 6> sides() {
    return {{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
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

  /// Node a lies at ξ = (sign(a, 0), sign(a, 1), sign(a, 2)).
  PLIANT_HOST_DEVICE static constexpr int sign(int a, int k) {
    return k == 2 ? (a >= 4 ? 1 : -1) : Quad4::sign(a % 4, k);
  }

 private:
  PLIANT_HOST_DEVICE static constexpr double factor(int a, int k, Vector<double, 3> const& xi) {
    return 1 + sign(a, k) * xi[k];
  }
};

}  // namespace pliant
