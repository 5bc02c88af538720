#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Saint Venant-Kirchhoff: W = λ/2 (tr E)² + μ tr E² with the Green strain E = (FᵀF − I)/2. Exact
/// under rotation; softens under compression (uniaxial stress: beyond the stretch 1/√3). Defined for every
/// F, but blind to inversion: a mirror image at rest has no energy. (Holzapfel, Nonlinear Solid Mechanics,
/// chapter 6.)
template <class T>
struct SaintVenantKirchhoff {
  T lambda, mu;  // Lamé's parameters, Pa: μ > 0, 3λ + 2μ > 0

  static constexpr bool takes_inversion = true;

  template <class S>
  PLIANT_HOST_DEVICE S energy(GreenInvariants<S> const& E) const {
    return lambda / 2 * square(E.trace) + mu * E.squares;
  }
  void check() const { detail::demand_lame("Saint Venant-Kirchhoff", lambda, mu); }
  static SaintVenantKirchhoff from(Elastic const& m) {
    return {T(m.lame_lambda()), T(m.lame_mu())};
  }
};

}  // namespace pliant
