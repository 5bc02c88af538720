#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Fung's law of soft tissue, isotropic: W = μ/(2b) (e^Q − 1), Q = b (2 tr E² + λ/μ (tr E)²) with
/// the Green strain E = (FᵀF − I)/2. Stiffens as its exponent grows, and softens under compression
/// as Saint Venant-Kirchhoff does, which it is for b → 0, and as blind to inversion. Defined for every F.
/// (Fung, Biomechanics: Mechanical
/// Properties of Living Tissues, section 7.11.)
template <class T>
struct Fung {
  T lambda, mu;  // Lamé's parameters at rest, Pa: μ > 0, 3λ + 2μ > 0
  T exponent;    // b, positive

  static constexpr bool takes_inversion = true;

  template <class S>
  PLIANT_HOST_DEVICE S energy(GreenInvariants<S> const& E) const {
    S const Q = exponent * (2 * E.squares + lambda / mu * square(E.trace));
    return mu / (2 * exponent) * expm1(Q);
  }
  void check() const {
    detail::demand_lame("Fung", lambda, mu);
    detail::demand(exponent > 0, "Fung's exponent", exponent, "be positive");
  }
  /// Unless known, b is 1.
  static Fung from(Elastic const& m, double exponent = 1) {
    return {T(m.lame_lambda()), T(m.lame_mu()), T(exponent)};
  }
};

}  // namespace pliant
