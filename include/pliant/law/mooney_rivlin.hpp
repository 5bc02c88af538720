#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Mooney-Rivlin, of rubber up to a stretch of about 2: W = c₁ (Ī₁ − 3) + c₂ (Ī₂ − 3) + κ/2 (J −
/// 1)². For J > 0. The shear modulus at rest is 2 (c₁ + c₂). (Rivlin, Philosophical Transactions A
/// 241 (1948) 379.)
template <class T>
struct MooneyRivlin {
  T c1, c2, bulk;  // Pa: c₁ + c₂ and κ positive

  static constexpr bool takes_inversion = false;

  template <class S>
  PLIANT_HOST_DEVICE S energy(MooneyInvariants<S> const& i) const {
    return c1 * i.I1_minus_3 + c2 * i.I2_minus_3 + bulk / 2 * square(i.J_minus_1);
  }
  void check() const {
    detail::demand(c1 + c2 > 0, "Mooney-Rivlin's c1 + c2", c1 + c2, "be positive (in Pa)");
    detail::demand(bulk > 0, "Mooney-Rivlin's bulk modulus", bulk, "be positive (in Pa)");
  }
  /// `share` of the shear modulus is that of Ī₂: between 0.1 and 0.3 for most rubbers.
  static MooneyRivlin from(Elastic const& m, double share = 0.25) {
    double const half = m.lame_mu() / 2;
    return {T((1 - share) * half), T(share * half), T(m.bulk())};
  }
};

}  // namespace pliant
