#pragma once

#include <pliant/quadrature/gauss.hpp>

namespace pliant {

/// The middle of Quad4 or Hex8 alone, with stiffness against the deformations that it does not see
/// (hourglasses; Flanagan and Belytschko 1981). Costs a quarter or an eighth of the full rule, and does
/// not lock in bending; energy in hourglasses tells how far to trust it. J of the mean deformation tells
/// whether an element is inverted: a corner may fold over before.
struct OnePoint {
  static constexpr bool controls_hourglasses = true;
  /// Of the stiffness with which a rectangle bends; less lets hourglasses show.
  static constexpr double share = 1;

  template <TensorCell Cell>
  PLIANT_HOST_DEVICE static constexpr auto rule() {
    return Gauss<1>::rule<Cell>();
  }
};

}  // namespace pliant
