#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Neo-Hookean, split into change of shape and of volume: W = μ/2 (Ī₁ − 3) + κ/2 (J − 1)². For
/// J > 0; under pressure alone the energy stays finite where J goes to 0. (Bonet and Wood, Nonlinear
/// Continuum Mechanics for Finite Element Analysis, section 6.5.)
template <class T>
struct IsochoricNeoHookean {
  T mu, bulk;  // shear modulus and bulk modulus κ, Pa: positive

  static constexpr bool takes_inversion = false;

  template <class S>
  PLIANT_HOST_DEVICE S energy(IsochoricInvariants<S> const& i) const {
    return mu / 2 * i.I1_minus_3 + bulk / 2 * square(i.J_minus_1);
  }
  void check() const {
    detail::demand(mu > 0, "the isochoric neo-Hookean law's mu", mu, "be positive (in Pa)");
    detail::demand(bulk > 0, "the isochoric neo-Hookean law's bulk modulus", bulk,
                   "be positive (in Pa)");
  }
  static IsochoricNeoHookean from(Elastic const& m) { return {T(m.lame_mu()), T(m.bulk())}; }
};

}  // namespace pliant
