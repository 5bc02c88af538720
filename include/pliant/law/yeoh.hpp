#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Yeoh, of filled rubber up to large strains: W = Σₖ cₖ (Ī₁ − 3)ᵏ + κ/2 (J − 1)², k = 1, 2, 3. For
/// J > 0. The shear modulus at rest is 2 c₁; c₂ is mostly negative, and c₃ > 0 stiffens the law
/// again. (Yeoh, Rubber Chemistry and Technology 66 (1993) 754.)
template <class T>
struct Yeoh {
  T c1, c2, c3, bulk;  // Pa: c₁ and κ positive

  static constexpr bool takes_inversion = false;

  template <class S>
  PLIANT_HOST_DEVICE S energy(IsochoricInvariants<S> const& i) const {
    return i.I1_minus_3 * (c1 + i.I1_minus_3 * (c2 + i.I1_minus_3 * c3)) +
           bulk / 2 * square(i.J_minus_1);
  }
  void check() const {
    detail::demand(c1 > 0, "Yeoh's c1", c1, "be positive (in Pa)");
    detail::demand(bulk > 0, "Yeoh's bulk modulus", bulk, "be positive (in Pa)");
  }
  /// With c₂ and c₃ as multiples of c₁; neo-Hookean where they are not known.
  static Yeoh from(Elastic const& m, double second = 0, double third = 0) {
    double const c1 = m.lame_mu() / 2;
    return {T(c1), T(second * c1), T(third * c1), T(m.bulk())};
  }
};

}  // namespace pliant
