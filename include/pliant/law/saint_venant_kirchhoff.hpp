#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Saint Venant-Kirchhoff: W = λ/2 (tr E)² + μ tr E² with the Green strain E = (FᵀF − I)/2. Exact
/// under rotation; softens under compression (uniaxial stress: beyond the stretch 1/√3).
template <class T>
struct SaintVenantKirchhoff {
  T lambda, mu;  // Lamé's parameters, Pa

  template <class S>
  PLIANT_HOST_DEVICE S energy(GreenInvariants<S> const& E) const {
    return lambda / 2 * square(E.trace) + mu * E.squares;
  }
  static SaintVenantKirchhoff from(Elastic const& m) {
    return {T(m.lame_lambda()), T(m.lame_mu())};
  }
};

}  // namespace pliant
