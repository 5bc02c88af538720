#pragma once

#include <pliant/element/quadratic_simplex.hpp>
#include <pliant/formulation/coefficients.hpp>
#include <pliant/math/unroll.hpp>

namespace pliant {

namespace detail {
/// Where the entry (k, l) of a symmetric tensor is kept.
PLIANT_HOST_DEVICE constexpr int symmetric_place(int k, int l) {
  return k <= l ? l * (l + 1) / 2 + k : k * (k + 1) / 2 + l;
}
/// The node of a quadratic simplex between two corners; the corner itself where they are the same.
template <SimplexCell Cell>
PLIANT_HOST_DEVICE constexpr int middle_of(int a, int b) {
  constexpr auto edges = Cell::edges();
  for (int e = 0; e < static_cast<int>(edges.size()); ++e) {
    auto const& edge = edges[static_cast<std::size_t>(e)];
    if ((edge[0] == a && edge[1] == b) || (edge[0] == b && edge[1] == a)) return Cell::corners + e;
  }
  return a;
}
}  // namespace detail

/// The differences of the corners, and how much the middles of edges differ from what those say: a quarter of the second
/// derivatives, which are constant. A derivative along ξ_k has d + 1 terms, where shape functions have one for each node.
template <CurvedSimplex E, class S>
struct Coefficients<E, S> {
  using Cell = typename E::cell;
  static constexpr int dim = E::dim;
  S corner[dim][dim];                   // v_k − v_0 of corner k + 1 at [k]
  S quarter[dim * (dim + 1) / 2][dim];  // ∂²v/∂ξ_k∂ξ_l / 4 at symmetric_place(k, l)

  PLIANT_HOST_DEVICE static Coefficients of(Nodal<E, S> const& v) {
    Coefficients d;
    for_each_pair([&](auto k, auto l) PLIANT_INLINE {
      constexpr int to_k = detail::middle_of<Cell>(0, k + 1),
                    to_l = detail::middle_of<Cell>(0, l + 1),
                    between = detail::middle_of<Cell>(k + 1, l + 1),
                    c = detail::symmetric_place(k, l);
      for (int i = 0; i < dim; ++i) {
        S const half = v(to_l, i) - v(0, i);
        if constexpr (k == l) {
          d.corner[k][i] = v(k + 1, i) - v(0, i);
          d.quarter[c][i] = d.corner[k][i] - (half + half);
        } else {
          d.quarter[c][i] = v(between, i) - v(to_k, i) - half;
        }
      }
    });
    return d;
  }
  PLIANT_HOST_DEVICE static Coefficients zero() {
    Coefficients d;
    for (auto& row : d.corner)
      for (S& x : row) x = S(0);
    for (auto& row : d.quarter)
      for (S& x : row) x = S(0);
    return d;
  }
  /// The differences of the corners 1 to d to corner 0, one per row.
  PLIANT_HOST_DEVICE Tensor<S, dim> to_corners() const {
    Tensor<S, dim> d;
    for (int a = 0; a < dim; ++a)
      for (int i = 0; i < dim; ++i) d(a, i) = corner[a][i];
    return d;
  }
  /// ∂v_i/∂ξ_k at point q.
  template <class Table>
  PLIANT_HOST_DEVICE Tensor<S, dim> gradient(Table const& table, int q) const {
    auto g = transpose(to_corners());
    for_each_slope(table, q, [&](auto k, auto c, builtin_scalar<S> x) PLIANT_INLINE {
      for (int i = 0; i < dim; ++i) g(i, k) = g(i, k) + quarter[c][i] * x;
    });
    return g;
  }
  /// Its transpose: adds Σ_k t_ik ∂N_a/∂ξ_k.
  template <class Table>
  PLIANT_HOST_DEVICE void add_divergence(Tensor<S, dim> const& t, Table const& table, int q) {
    for (int k = 0; k < dim; ++k)
      for (int i = 0; i < dim; ++i) corner[k][i] = corner[k][i] + t(i, k);
    for_each_slope(table, q, [&](auto k, auto c, builtin_scalar<S> x) PLIANT_INLINE {
      for (int i = 0; i < dim; ++i) quarter[c][i] = quarter[c][i] + t(i, k) * x;
    });
  }
  /// The transpose of `of`: what was added, per node.
  PLIANT_HOST_DEVICE Nodal<E, S> per_node() const {
    Nodal<E, S> f;
    for (int i = 0; i < dim; ++i) {
      S sum = S(0);
      unroll<dim>([&](auto k) PLIANT_INLINE {
        S const& own = quarter[detail::symmetric_place(k, k)][i];
        f(k + 1, i) = corner[k][i] + own;
        S half = -(own + own);
        unroll<dim>([&](auto l) PLIANT_INLINE {
          S const& mixed = quarter[detail::symmetric_place(k, l)][i];
          if constexpr (k != l) half = half - mixed;
          if constexpr (k < l) {
            f(detail::middle_of<Cell>(k + 1, l + 1), i) = mixed;
            sum = sum + mixed;
          }
        });
        f(detail::middle_of<Cell>(0, k + 1), i) = half;
        sum = sum + f(k + 1, i) + half;
      });
      f(0, i) = -sum;
    }
    return f;
  }

 private:
  /// f(k, l) for k ≤ l.
  template <class F>
  PLIANT_HOST_DEVICE static void for_each_pair(F const& f) {
    unroll<dim>([&](auto l)
                    PLIANT_INLINE { unroll<l + 1>([&](auto k) PLIANT_INLINE { f(k, l); }); });
  }
  /// f(k, c, x) for what quarter[c] adds at point q to the derivative along ξ_k: x times itself, where x is 4 ξ_l, and
  /// along an edge of corner 0, which its corner tells in the middle, 4 ξ_k − 2.
  template <class Table, class F>
  PLIANT_HOST_DEVICE static void for_each_slope(Table const& table, int q, F const& f) {
    using T = builtin_scalar<S>;
    unroll<dim>([&](auto l) PLIANT_INLINE {
      T const x = T(4) * table.monomial[q][power(Table::exponents, l)];
      unroll<dim>([&](auto k) PLIANT_INLINE {
        f(k, std::integral_constant<int, detail::symmetric_place(k, l)>(), k == l ? x - T(2) : x);
      });
    });
  }
};

}  // namespace pliant
