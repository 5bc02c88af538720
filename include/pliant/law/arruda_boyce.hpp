#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Arruda-Boyce, of rubber as chains along the diagonals of a cube, to the fifth order of the
/// inverse Langevin function: W = μ₀ Σₖ aₖ/λₘ^(2k−2) (Ī₁ᵏ − 3ᵏ) + κ/2 (J − 1)² with a = 1/2, 1/20,
/// 11/1050, 19/7000, 519/673750. For J > 0; true to the chains while the stretch is well below the
/// locking stretch λₘ, beyond which the series goes on without locking. (Arruda and Boyce, Journal
/// of the Mechanics and Physics of Solids 41 (1993) 389.)
template <class T>
struct ArrudaBoyce {
  T mu;       // μ₀ = nkT, less than the shear modulus at rest, Pa: positive
  T locking;  // λₘ, above 1
  T bulk;     // κ, Pa: positive

  static constexpr bool takes_inversion = false;

  template <class S>
  PLIANT_HOST_DEVICE S energy(IsochoricInvariants<S> const& i) const {
    // Σ aₖ (uᵏ − u₀ᵏ) = (u − u₀) Σ eₘ uᵐ with eₘ = aₘ₊₁ + u₀ eₘ₊₁, which is 0 for m = 5
    T const per_square = 1 / square(locking), rest = 3 * per_square;
    S const u = (3 + i.I1_minus_3) * per_square;
    T factor = T(coefficient(5));
    S sum = S(factor);
    for (int k = 4; k >= 1; --k) {
      factor = T(coefficient(k)) + rest * factor;
      sum = u * sum + factor;
    }
    return mu * i.I1_minus_3 * sum + bulk / 2 * square(i.J_minus_1);
  }
  void check() const {
    detail::demand(mu > 0, "Arruda-Boyce's mu", mu, "be positive (in Pa)");
    detail::demand(locking > 1, "Arruda-Boyce's locking stretch", locking, "be above 1");
    detail::demand(bulk > 0, "Arruda-Boyce's bulk modulus", bulk, "be positive (in Pa)");
  }
  /// Unless known, λₘ is 7.
  static ArrudaBoyce from(Elastic const& m, double locking = 7) {
    double stiffening = 0;  // μ/μ₀
    for (int k = 1; k <= 5; ++k)
      stiffening += 2 * k * coefficient(k) * std::pow(3 / (locking * locking), k - 1);
    return {T(m.lame_mu() / stiffening), T(locking), T(m.bulk())};
  }

 private:
  PLIANT_HOST_DEVICE static constexpr double coefficient(int k) {
    return k == 1   ? 1.0 / 2
           : k == 2 ? 1.0 / 20
           : k == 3 ? 11.0 / 1050
           : k == 4 ? 19.0 / 7000
                    : 519.0 / 673750;
  }
};

}  // namespace pliant
