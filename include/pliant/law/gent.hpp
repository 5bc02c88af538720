#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Gent, of rubber whose chains can stretch no further: W = −μ Jₘ/2 ln(1 − (Ī₁ − 3)/Jₘ) + κ/2 (J −
/// 1)². For J > 0 and Ī₁ − 3 < Jₘ: the energy goes to infinity there; beyond, it and the stress are
/// not numbers, so that no solver takes such a state for an answer. (Gent, Rubber Chemistry and Technology 69 (1996) 59.)
template <class T>
struct Gent {
  T mu;     // shear modulus at rest, Pa: positive
  T limit;  // Jₘ, the Ī₁ − 3 that is never reached: positive
  T bulk;   // κ, Pa: positive

  static constexpr bool takes_inversion = false;

  template <class S>
  PLIANT_HOST_DEVICE S energy(IsochoricInvariants<S> const& i) const {
    S const share = i.I1_minus_3 / limit;
    S const spent = select(share < S(1), share, not_a_number<S>());
    return -mu * limit / 2 * log1p(-spent) + bulk / 2 * square(i.J_minus_1);
  }
  void check() const {
    detail::demand(mu > 0, "Gent's mu", mu, "be positive (in Pa)");
    detail::demand(limit > 0, "Gent's limit", limit, "be positive");
    detail::demand(bulk > 0, "Gent's bulk modulus", bulk, "be positive (in Pa)");
  }
  /// Unless known, Jₘ is 97.2, what fits Treloar's rubber: a uniaxial stretch of 10.
  static Gent from(Elastic const& m, double limit = 97.2) {
    return {T(m.lame_mu()), T(limit), T(m.bulk())};
  }
};

}  // namespace pliant
