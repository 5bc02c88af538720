#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Neo-Hookean without a logarithm: W = μ/2 (I₁ − 3) − μ (J − 1) + (λ + μ)/2 (J − 1)². Defined for
/// every F, inverted and flattened too. The first form of Smith, de Goes and Kim (Stable
/// Neo-Hookean Flesh Simulation, ACM Trans. Graph. 37, 2018, section 3.2), whose λ is λ + μ here,
/// so that these are Lamé's parameters.
template <class T>
struct StableNeoHookean {
  T lambda, mu;  // Lamé's parameters, Pa: μ > 0, 3λ + 2μ > 0

  static constexpr bool takes_inversion = true;

  template <class S>
  PLIANT_HOST_DEVICE S energy(CauchyGreenInvariants<S> const& i) const {
    return mu / 2 * i.D + (lambda + mu) / 2 * square(i.J_minus_1);
  }
  void check() const { detail::demand_lame("the stable neo-Hookean law", lambda, mu); }
  static StableNeoHookean from(Elastic const& m) { return {T(m.lame_lambda()), T(m.lame_mu())}; }
};

}  // namespace pliant
