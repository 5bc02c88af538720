#pragma once

#include <pliant/element/linear.hpp>
#include <pliant/formulation/formulation.hpp>
#include <pliant/math/unroll.hpp>

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

/// The coefficients of the monomials Π_{k∈b} ξ_k, b a set of directions as bits: a butterfly over the
/// nodes makes them, and each derivative has half as many terms as there are nodes.
template <Multilinear E, class S>
struct Coefficients<E, S> {
  S c[E::nodes][E::dim];  // c[0], the constant, is not used

  PLIANT_HOST_DEVICE static Coefficients of(Nodal<E, S> const& v) {
    using T = builtin_scalar<S>;
    Coefficients m;
    unroll<E::nodes>([&](auto a) PLIANT_INLINE {
      for (int i = 0; i < E::dim; ++i)
        m.c[corner(a)][i] = a == 0 ? S(0) : T(1.0 / E::nodes) * (v(a, i) - v(0, i));
    });
    m.for_each_pair([](S& low, S& high) PLIANT_INLINE {
      S const sum = high + low;
      high = high - low;
      low = sum;
    });
    return m;
  }
  PLIANT_HOST_DEVICE static Coefficients zero() {
    Coefficients m;
    for (auto& row : m.c)
      for (S& x : row) x = S(0);
    return m;
  }
  template <class Table>
  PLIANT_HOST_DEVICE Tensor<S, E::dim> gradient(Table const& table, int q) const {
    Tensor<S, E::dim> g;
    unroll<E::dim>([&](auto k) PLIANT_INLINE {
      for (int i = 0; i < E::dim; ++i) g(i, k) = c[1 << k][i];
      unroll<E::nodes>([&](auto b) PLIANT_INLINE {
        if constexpr ((b >> k & 1) && b != 1 << k)
          for (int i = 0; i < E::dim; ++i)
            g(i, k) = g(i, k) + table.monomial[q][b & ~(1 << k)] * c[b][i];
      });
    });
    return g;
  }
  template <class Table>
  PLIANT_HOST_DEVICE void add_divergence(Tensor<S, E::dim> const& t, Table const& table, int q) {
    unroll<E::dim>([&](auto k) PLIANT_INLINE {
      for (int i = 0; i < E::dim; ++i) c[1 << k][i] = c[1 << k][i] + t(i, k);
      unroll<E::nodes>([&](auto b) PLIANT_INLINE {
        if constexpr ((b >> k & 1) && b != 1 << k)
          for (int i = 0; i < E::dim; ++i)
            c[b][i] = c[b][i] + table.monomial[q][b & ~(1 << k)] * t(i, k);
      });
    });
  }
  PLIANT_HOST_DEVICE Nodal<E, S> per_node() const {
    using T = builtin_scalar<S>;
    Coefficients m = *this;
    for (S& x : m.c[0]) x = S(0);
    m.for_each_pair([](S& even, S& odd) PLIANT_INLINE {
      S const sum = even + odd;
      even = even - odd;
      odd = sum;
    });
    Nodal<E, S> f;
    unroll<E::nodes>([&](auto a) PLIANT_INLINE {
      for (int i = 0; i < E::dim; ++i) f(a, i) = T(1.0 / E::nodes) * m.c[corner(a)][i];
    });
    return f;
  }

 private:
  /// A node's corner as bits: 1 where ξ_k = 1.
  PLIANT_HOST_DEVICE static constexpr int corner(int a) {
    int b = 0;
    for (int k = 0; k < E::dim; ++k) b |= (E::cell::corner(a)[k] > 0 ? 1 : 0) << k;
    return b;
  }
  /// f(without direction k, with it) for all sets of directions, k after k: a butterfly.
  template <class F>
  PLIANT_HOST_DEVICE void for_each_pair(F const& f) {
    unroll<E::dim>([&](auto k) PLIANT_INLINE {
      unroll<E::nodes>([&](auto b) PLIANT_INLINE {
        if constexpr (!(b >> k & 1))
          for (int i = 0; i < E::dim; ++i) f(c[b][i], c[b | 1 << k][i]);
      });
    });
  }
};

}  // namespace pliant
