#pragma once

#include <pliant/quadrature/quadrature.hpp>

namespace pliant {

/// The corners of a cell with equal weights, in the order of the linear element's nodes. Not for
/// forces: a place to look at (is a map folded anywhere?) and the nodal rule of linear elements.
struct Corners {
  template <class Cell>
  PLIANT_HOST_DEVICE static constexpr auto rule() {
    constexpr int dim = Cell::dim;
    if constexpr (std::same_as<Cell, Triangle> || std::same_as<Cell, Tetrahedron>) {
      QuadratureRule<dim, dim + 1> rule{};
      for (int a = 0; a <= dim; ++a) {
        if (a > 0) rule.points[a][a - 1] = 1;
        rule.weights[a] = (dim == 2 ? 1.0 / 2 : 1.0 / 6) / (dim + 1);
      }
      return rule;
    } else {
      QuadratureRule<dim, 1 << dim> rule{};
      for (int a = 0; a < (1 << dim); ++a) {
        // Counter-clockwise around ξ₂ = −1, then ξ₂ = 1.
        rule.points[a][0] = a % 4 == 1 || a % 4 == 2 ? 1 : -1;
        rule.points[a][1] = a % 4 >= 2 ? 1 : -1;
        if constexpr (dim == 3) rule.points[a][2] = a >= 4 ? 1 : -1;
        rule.weights[a] = 1;
      }
      return rule;
    }
  }
};

}  // namespace pliant
