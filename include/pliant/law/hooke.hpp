#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Hooke's law of linear elasticity: W = λ/2 (tr e)² + μ e:e with e = sym H. Cheap, and wrong as
/// soon as elements rotate: a rotation by θ makes a strain of cos θ − 1. Defined for every F, inverted
/// and flattened too. (Landau and Lifshitz, Theory of Elasticity, section 4.)
template <class T>
struct Hooke {
  T lambda, mu;  // Lamé's parameters, Pa: μ > 0, 3λ + 2μ > 0

  static constexpr bool takes_inversion = true;

  template <class S>
  PLIANT_HOST_DEVICE S energy(StrainInvariants<S> const& e) const {
    return lambda / 2 * square(e.trace) + mu * e.squares;
  }
  void check() const { detail::demand_lame("Hooke", lambda, mu); }
  static Hooke from(Elastic const& m) { return {T(m.lame_lambda()), T(m.lame_mu())}; }
};

}  // namespace pliant
