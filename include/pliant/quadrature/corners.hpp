#pragma once

#include <pliant/quadrature/quadrature.hpp>

namespace pliant {

/// The corners of a cell with equal weights, in their order. Not for forces: a place to look at (is a
/// map folded anywhere?). Pyramids have no such rule: their shape functions have no gradient at the
/// apex.
struct Corners {
  template <class Cell>
    requires(!std::same_as<Cell, Pyramid>)
  PLIANT_HOST_DEVICE static constexpr auto rule() {
    QuadratureRule<Cell::dim, Cell::corners> rule{};
    for (int a = 0; a < Cell::corners; ++a) {
      for (int k = 0; k < Cell::dim; ++k) rule.points[a][k] = Cell::corner(a)[k];
      rule.weights[a] = Cell::volume / Cell::corners;
    }
    return rule;
  }
};

}  // namespace pliant
