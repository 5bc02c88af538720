#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Ogden, of rubber at all strains: W = Σₚ μₚ/αₚ (λ̄₁^αₚ + λ̄₂^αₚ + λ̄₃^αₚ − 3) + κ/2 (J − 1)², three
/// terms in the isochoric stretches λ̄ = J^(−1/3) λ. For J > 0. The shear modulus at rest is Σ μₚ
/// αₚ/2; a term that is not wanted has μₚ = 0, and no αₚ may be 0. (Ogden, Proceedings of the Royal
/// Society A 326 (1972) 565.)
template <class T>
struct Ogden {
  T mu[3];     // μₚ, Pa
  T alpha[3];  // αₚ
  T bulk;      // κ, Pa: positive

  static constexpr bool takes_inversion = false;

  template <class S>
  PLIANT_HOST_DEVICE S energy(PrincipalStretches<S> const& l) const {
    S const log_1 = log1p(l[0]), log_2 = log1p(l[1]), log_3 = log1p(l[2]);
    S const log_J = log_1 + log_2 + log_3, mean = log_J / 3;
    S const log_bar[3] = {log_1 - mean, log_2 - mean, log_3 - mean};  // of the isochoric stretches
    S w = bulk / 2 * square(expm1(log_J));
    for (int p = 0; p < 3; ++p) w = w + term(mu[p], alpha[p], log_bar);
    return w;
  }
  void check() const {
    for (T a : alpha)
      detail::demand(a != 0, "an alpha of Ogden", a, "not be 0, even where its mu is");
    T const shear = (mu[0] * alpha[0] + mu[1] * alpha[1] + mu[2] * alpha[2]) / 2;
    detail::demand(shear > 0, "Ogden's shear modulus, half the sum of mu alpha,", shear,
                   "be positive (in Pa)");
    detail::demand(bulk > 0, "Ogden's bulk modulus", bulk, "be positive (in Pa)");
  }
  /// With the exponents and the proportions of Treloar's rubber (Ogden 1972).
  static Ogden from(Elastic const& m) {
    double const unit = m.lame_mu() / 4.225;
    return {{T(6.3 * unit), T(0.012 * unit), T(-0.1 * unit)}, {T(1.3), T(5), T(-2)}, T(m.bulk())};
  }

 private:
  /// μ/α (λ̄₁^α + λ̄₂^α + λ̄₃^α − 3), where from each power goes α ln λ̄ too: their sum is 0.
  template <class S>
  PLIANT_HOST_DEVICE static S term(T const& mu, T const& alpha, S const (&log_bar)[3]) {
    return mu / alpha *
           (excess_of_expm1(alpha * log_bar[0]) + excess_of_expm1(alpha * log_bar[1]) +
            excess_of_expm1(alpha * log_bar[2]));
  }
};

}  // namespace pliant
