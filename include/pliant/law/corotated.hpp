#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Corotated linear: W = μ |F − R|² + λ/2 (tr(RᵀF − I))² = μ Σ (λₖ − 1)² + λ/2 (Σ (λₖ − 1))² in the
/// stretches of the polar decomposition F = R U, R a rotation. Hooke's law without its error under
/// rotation, and no more than that: it does not resist inversion. Where J < 0, R stays a rotation; it
/// jumps where the sum of two stretches is 0. (Chao, Pinkall, Sanan and Schröder, A simple geometric
/// model for elastic deformations, ACM Trans. Graph. 29, 2010.)
template <class T>
struct Corotated {
  T lambda, mu;  // Lamé's parameters, Pa

  template <class S>
  PLIANT_HOST_DEVICE S energy(PrincipalStretches<S> const& l) const {
    S const trace = l[0] + l[1] + l[2];
    return mu * (square(l[0]) + square(l[1]) + square(l[2])) + lambda / 2 * square(trace);
  }
  static Corotated from(Elastic const& m) { return {T(m.lame_lambda()), T(m.lame_mu())}; }
};

}  // namespace pliant
