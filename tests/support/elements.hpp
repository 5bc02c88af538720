#pragma once

#include <pliant/element/linear.hpp>
#include <pliant/element/quadratic_simplex.hpp>
#include <pliant/element/quadratic_tensor.hpp>

// Every element, for TEMPLATE_TEST_CASE.
#define PLANE_ELEMENTS Tri3, Tri6, Quad4, Quad8, Quad9
#define SOLID_ELEMENTS Tet4, Tet10, Hex8, Hex20, Hex27, Wedge6, Pyramid5
#define ALL_ELEMENTS PLANE_ELEMENTS, SOLID_ELEMENTS

namespace pliant::test {

/// The middle of a cell's corners.
template <class Cell>
Vector<double, Cell::dim> middle_of() {
  auto sum = Vector<double, Cell::dim>::zero();
  for (int a = 0; a < Cell::corners; ++a) sum = sum + 1.0 / Cell::corners * Cell::corner(a);
  return sum;
}

}  // namespace pliant::test
