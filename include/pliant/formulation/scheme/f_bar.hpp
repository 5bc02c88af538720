#pragma once

#include <pliant/quadrature/quadrature.hpp>

namespace pliant {

/// A rule whose points see the element's mean dilatation: F̄ = (J̄/J)^(1/3) F with J̄ the mean of J over
/// the element, sym H̄ = sym H + (θ̄ − θ)/3 I for laws of small strain. The answer to volumetric locking
/// of nearly incompressible elements (Nagtegaal, Parks, Rice 1974; Simo, Taylor, Pister 1985). On Quad8,
/// Quad9, Hex20 and Hex27 the mean is the linear function of ξ nearest to J, and they keep their order;
/// on all others it is a constant. One Tri6 or Tet10 has one pressure (Tet10 with Gauss<3>: four points
/// would leave deformations free, and one Tet10 by itself three in any case). Forces derive from the
/// energy at F̄, which is NaN where J and J̄ differ in sign.
template <class Q>
struct FBar {
  using points = Q;
  template <class Cell>
  PLIANT_HOST_DEVICE static constexpr auto rule() {
    return Q::template rule<Cell>();
  }
};

/// Whether a rule is an FBar.
template <class Q>
inline constexpr bool has_mean_dilatation = false;
template <class Q>
inline constexpr bool has_mean_dilatation<FBar<Q>> = true;

}  // namespace pliant
