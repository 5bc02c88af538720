#pragma once

#include <pliant/quadrature/quadrature.hpp>

namespace pliant {

/// A rule whose points all see the element's mean dilatation: F̄ = (J̄/J)^(1/3) F with J̄ the mean of J
/// over the element, sym H̄ = sym H + (θ̄ − θ)/3 I for laws of small strain. The answer to volumetric
/// locking of nearly incompressible Quad4 and Hex8 (Nagtegaal, Parks, Rice 1974; Simo, Taylor, Pister
/// 1985); makes Tri6 and Tet10 quadratic in displacement with one pressure (there with Gauss<3>: four
/// points would leave deformations free, and one Tet10 by itself three in any case). Forces derive from
/// the energy at F̄.
template <class Q>
struct FBar {
  using points = Q;
  template <class Cell>
  PLIANT_HOST_DEVICE static constexpr auto rule() {
    return Q::template rule<Cell>();
  }
};

template <class Q>
inline constexpr bool has_mean_dilatation = false;
template <class Q>
inline constexpr bool has_mean_dilatation<FBar<Q>> = true;

}  // namespace pliant
