#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Neo-Hookean, split into change of shape and of volume: W = μ/2 (Ī₁ − 3) + κ/4 (J² − 1 − 2 ln J).
/// For J > 0; its energy grows beyond bounds where J goes to 0. (Simo, Computer Methods in Applied
/// Mechanics and Engineering 66 (1988) 199.)
template <class T>
struct SimoNeoHookean {
  T mu, bulk;  // shear modulus and bulk modulus κ, Pa: positive

  static constexpr bool takes_inversion = false;

  template <class S>
  PLIANT_HOST_DEVICE S energy(IsochoricInvariants<S> const& i) const {
    return mu / 2 * i.I1_minus_3 +
           bulk / 4 * (square(i.J_minus_1) + 2 * excess_of_log1p(i.J_minus_1));
  }
  void check() const {
    detail::demand(mu > 0, "Simo's neo-Hookean mu", mu, "be positive (in Pa)");
    detail::demand(bulk > 0, "Simo's neo-Hookean bulk modulus", bulk, "be positive (in Pa)");
  }
  static SimoNeoHookean from(Elastic const& m) { return {T(m.lame_mu()), T(m.bulk())}; }
};

}  // namespace pliant
