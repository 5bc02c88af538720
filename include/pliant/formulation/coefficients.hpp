#pragma once

#include <pliant/element/linear.hpp>
#include <pliant/formulation/formulation.hpp>

namespace pliant {

/// A nodal field in the basis in which its gradient costs least; made once per element, used at each
/// quadrature point. All bases are differences of nodal values: the position of an element in space is
/// never rounded into its gradients. Here: differences to node 0, and the tabulated gradients.
template <Element E, class S>
struct Coefficients {
  S c[E::nodes - 1][E::dim];

  PLIANT_HOST_DEVICE static Coefficients of(Nodal<E, S> const& v) {
    Coefficients d;
    for (int a = 1; a < E::nodes; ++a)
      for (int i = 0; i < E::dim; ++i) d.c[a - 1][i] = v(a, i) - v(0, i);
    return d;
  }
  PLIANT_HOST_DEVICE static Coefficients zero() {
    Coefficients d;
    for (auto& row : d.c)
      for (S& x : row) x = S(0);
    return d;
  }
  /// The differences of the corners 1 to d of a simplex to corner 0, one per row.
  PLIANT_HOST_DEVICE Tensor<S, E::dim> to_corners() const {
    Tensor<S, E::dim> d;
    for (int a = 0; a < E::dim; ++a)
      for (int i = 0; i < E::dim; ++i) d(a, i) = c[a][i];
    return d;
  }
  /// ∂v_i/∂ξ_k at point q.
  template <class Table>
  PLIANT_HOST_DEVICE Tensor<S, E::dim> gradient(Table const& table, int q) const {
    using T = builtin_scalar<S>;
    Tensor<S, E::dim> g;
    for (int i = 0; i < E::dim; ++i)
      for (int k = 0; k < E::dim; ++k) {
        g(i, k) = c[0][i] * T(table.gradient[q][1][k]);
        for (int a = 2; a < E::nodes; ++a)
          g(i, k) = g(i, k) + c[a - 1][i] * T(table.gradient[q][a][k]);
      }
    return g;
  }
  /// Adds Σ_k t_ik ∂N_a/∂ξ_k: the transpose of `gradient`.
  template <class Table>
  PLIANT_HOST_DEVICE void add_divergence(Tensor<S, E::dim> const& t, Table const& table, int q) {
    using T = builtin_scalar<S>;
    for (int a = 1; a < E::nodes; ++a)
      for (int i = 0; i < E::dim; ++i)
        for (int k = 0; k < E::dim; ++k)
          c[a - 1][i] = c[a - 1][i] + t(i, k) * T(table.gradient[q][a][k]);
  }
  /// The transpose of `of`: what was added, per node.
  PLIANT_HOST_DEVICE Nodal<E, S> per_node() const {
    Nodal<E, S> f;
    for (int i = 0; i < E::dim; ++i) {
      S sum = c[0][i];
      for (int a = 1; a < E::nodes; ++a) {
        f(a, i) = c[a - 1][i];
        if (a > 1) sum = sum + c[a - 1][i];
      }
      f(0, i) = -sum;
    }
    return f;
  }
};

/// The same differences; they are the gradient.
template <LinearSimplex E, class S>
struct Coefficients<E, S> {
  S c[E::dim][E::dim];

  PLIANT_HOST_DEVICE static Coefficients of(Nodal<E, S> const& v) {
    Coefficients d;
    for (int k = 0; k < E::dim; ++k)
      for (int i = 0; i < E::dim; ++i) d.c[k][i] = v(k + 1, i) - v(0, i);
    return d;
  }
  PLIANT_HOST_DEVICE static Coefficients zero() {
    Coefficients d;
    for (auto& row : d.c)
      for (S& x : row) x = S(0);
    return d;
  }
  /// The differences of the corners 1 to d to corner 0, one per row.
  PLIANT_HOST_DEVICE Tensor<S, E::dim> to_corners() const {
    Tensor<S, E::dim> d;
    for (int a = 0; a < E::dim; ++a)
      for (int i = 0; i < E::dim; ++i) d(a, i) = c[a][i];
    return d;
  }
  template <class Table>
  PLIANT_HOST_DEVICE Tensor<S, E::dim> gradient(Table const&, int) const {
    Tensor<S, E::dim> g;
    for (int i = 0; i < E::dim; ++i)
      for (int k = 0; k < E::dim; ++k) g(i, k) = c[k][i];
    return g;
  }
  template <class Table>
  PLIANT_HOST_DEVICE void add_divergence(Tensor<S, E::dim> const& t, Table const&, int) {
    for (int i = 0; i < E::dim; ++i)
      for (int k = 0; k < E::dim; ++k) c[k][i] = c[k][i] + t(i, k);
  }
  PLIANT_HOST_DEVICE Nodal<E, S> per_node() const {
    Nodal<E, S> f;
    for (int i = 0; i < E::dim; ++i) {
      S sum = c[0][i];
      for (int k = 1; k < E::dim; ++k) sum = sum + c[k][i];
      f(0, i) = -sum;
      for (int k = 0; k < E::dim; ++k) f(k + 1, i) = c[k][i];
    }
    return f;
  }
};

}  // namespace pliant
