#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Compressible neo-Hookean: W = μ/2 (I₁ − 3) − μ ln J + λ/2 (ln J)². For J > 0.
/// Written as μ/2 (I₁ − 3 − 2(J − 1)) + μ (J − 1 − ln J) + λ/2 (ln J)², whose terms are all of
/// second order in the strain: nothing cancels in single precision. (Bonet and Wood, Nonlinear
/// Continuum Mechanics for Finite Element Analysis, section 6.4.3.)
template <class T>
struct NeoHookean {
  T lambda, mu;  // Lamé's parameters, Pa: μ > 0, 3λ + 2μ > 0

  static constexpr bool takes_inversion = false;

  template <class S>
  PLIANT_HOST_DEVICE S energy(CauchyGreenInvariants<S> const& i) const {
    return mu / 2 * i.D + mu * excess_of_log1p(i.J_minus_1) +
           lambda / 2 * square(log1p(i.J_minus_1));
  }
  void check() const { detail::demand_lame("the neo-Hookean law", lambda, mu); }
  static NeoHookean from(Elastic const& m) { return {T(m.lame_lambda()), T(m.lame_mu())}; }
};

}  // namespace pliant
