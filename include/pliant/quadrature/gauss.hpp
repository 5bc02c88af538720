#pragma once

#include <pliant/quadrature/jacobi.hpp>
#include <pliant/quadrature/simplex_rules.hpp>

namespace pliant {

/// Gauss quadrature. On tensor cells and pyramids N points per direction, exact to degree 2N − 1; on
/// simplices a rule that is exact to degree N or more; on wedges that of triangles times N points
/// along the axis.
template <int N>
struct Gauss {
  template <class Cell>
  PLIANT_HOST_DEVICE static constexpr auto rule() {
    if constexpr (std::same_as<Cell, Triangle>)
      return detail::triangle_rule<N>();
    else if constexpr (std::same_as<Cell, Tetrahedron>)
      return detail::tetrahedron_rule<N>();
    else if constexpr (std::same_as<Cell, Wedge>)
      return detail::on_wedge(detail::triangle_rule<N>(), detail::gauss_jacobi<N>());
    else if constexpr (std::same_as<Cell, Pyramid>)
      return detail::on_pyramid<N>();
    else
      return detail::tensor_product<Cell::dim>(detail::gauss_jacobi<N>());
  }
};

}  // namespace pliant
