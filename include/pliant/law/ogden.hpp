#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Ogden, of rubber at all strains: W = Σₚ μₚ/αₚ (λ̄₁^αₚ + λ̄₂^αₚ + λ̄₃^αₚ − 3) + κ/2 (J − 1)², three
/// terms in the isochoric stretches λ̄ = J^(−1/3) λ. For J > 0. The shear modulus at rest is Σ μₚ αₚ/2;
/// a term that is not wanted has μₚ = 0, and no αₚ may be 0. (Ogden, Proceedings of the Royal Society
/// A 326 (1972) 565.)
template <class T>
struct Ogden {
  T mu[3];     // μₚ, Pa
  T alpha[3];  // αₚ
  T bulk;      // κ, Pa

  template <class S>
  PLIANT_HOST_DEVICE S energy(PrincipalStretches<S> const& l) const {
    S const log_l[3] = {log1p(l[0]), log1p(l[1]), log1p(l[2])};
    S const log_J = log_l[0] + log_l[1] + log_l[2];
    S w = bulk / 2 * square(expm1(log_J));
    // The sum of all α ln λ̄ is 0, which is taken from each power with its 1.
    for (int p = 0; p < 3; ++p)
      for (int k = 0; k < 3; ++k)
        w = w + mu[p] / alpha[p] * excess_of_expm1(alpha[p] * (log_l[k] - log_J / 3));
    return w;
  }
  /// With the exponents and the proportions of Treloar's rubber (Ogden 1972).
  static Ogden from(Elastic const& m) {
    double const unit = m.lame_mu() / 4.225;
    return {{T(6.3 * unit), T(0.012 * unit), T(-0.1 * unit)}, {T(1.3), T(5), T(-2)}, T(m.bulk())};
  }
};

}  // namespace pliant
