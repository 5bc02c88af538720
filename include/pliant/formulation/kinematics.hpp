#pragma once

#include <pliant/formulation/formulation.hpp>

namespace pliant {

/// Derivatives on the reference cell, ∂v_i/∂ξ_k = Σ_a v_a,i ∂N_a/∂ξ_k, from differences to node 0:
/// the position of the element in space is never rounded into them.
template <Element E, class S, class Table>
PLIANT_HOST_DEVICE Tensor<S, E::dim> parametric_gradient(Nodal<E, S> const& v, Table const& table,
                                                         int q) {
  using T = builtin_scalar<S>;
  Tensor<S, E::dim> g;
  for (int i = 0; i < E::dim; ++i)
    for (int k = 0; k < E::dim; ++k) {
      if constexpr (LinearSimplex<E>) {
        g(i, k) = v(k + 1, i) - v(0, i);
      } else {
        S sum = (v(1, i) - v(0, i)) * T(table.gradient[q][1][k]);
        for (int a = 2; a < E::nodes; ++a)
          sum = sum + (v(a, i) - v(0, i)) * T(table.gradient[q][a][k]);
        g(i, k) = sum;
      }
    }
  return g;
}

/// Adds the nodal vectors Σ_k t_ik ∂N_a/∂ξ_k: the transpose of `parametric_gradient`.
template <Element E, class S, class Table>
PLIANT_HOST_DEVICE void add_parametric_divergence(Tensor<S, E::dim> const& t, Table const& table,
                                                  int q, Nodal<E, S>& f) {
  using T = builtin_scalar<S>;
  for (int i = 0; i < E::dim; ++i) {
    if constexpr (LinearSimplex<E>) {
      S sum = t(i, 0);
      for (int k = 1; k < E::dim; ++k) sum = sum + t(i, k);
      f(0, i) = f(0, i) - sum;
      for (int k = 0; k < E::dim; ++k) f(k + 1, i) = f(k + 1, i) + t(i, k);
    } else {
      for (int a = 0; a < E::nodes; ++a)
        for (int k = 0; k < E::dim; ++k) f(a, i) = f(a, i) + t(i, k) * T(table.gradient[q][a][k]);
    }
  }
}

/// The map from the reference cell to rest space at one quadrature point.
template <Element E, class S>
struct RestMap {
  Tensor<S, E::dim> cofactors;  // cof J = det J · J⁻ᵀ
  S volume;                     // det J
  S inverse_volume;

  template <class Table>
  PLIANT_HOST_DEVICE static RestMap at(Nodal<E, S> const& rest, Table const& table, int q) {
    Tensor<S, E::dim> const j = parametric_gradient<E>(rest, table, q);
    Tensor<S, E::dim> const c = cofactor(j);
    S det = j(0, 0) * c(0, 0);
    for (int k = 1; k < E::dim; ++k) det = det + j(0, k) * c(0, k);
    return {c, det, reciprocal(det)};
  }

  /// ∂v/∂X from ∂v/∂ξ.
  PLIANT_HOST_DEVICE Tensor<S, E::dim> in_rest_space(Tensor<S, E::dim> const& g) const {
    return inverse_volume * (g * transpose(cofactors));
  }
};

}  // namespace pliant
