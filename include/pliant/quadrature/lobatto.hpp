#pragma once

#include <pliant/quadrature/jacobi.hpp>

namespace pliant {

/// Gauss-Lobatto quadrature on quadrilaterals and hexahedra: N points per direction, the ends among
/// them, exact to degree 2N − 3. With N = 3 its points are the nodes of Quad9 and Hex27.
template <int N>
struct Lobatto {
  template <class Cell>
  PLIANT_HOST_DEVICE static constexpr auto rule() {
    static_assert(
        TensorCell<Cell>,
        "Lobatto<n> is a rule for quadrilaterals and hexahedra; take Gauss<n> or Exact<degree> "
        "on other cells");
    return detail::tensor_product<Cell::dim>(detail::gauss_lobatto<N>());
  }
};

}  // namespace pliant
