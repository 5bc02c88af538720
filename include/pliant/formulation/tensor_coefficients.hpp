#pragma once

#include <pliant/element/lattice.hpp>
#include <pliant/formulation/coefficients.hpp>
#include <pliant/math/unroll.hpp>

namespace pliant {

/// The coefficients of the monomials Π ξ_k^b_k: sums and differences along lines of nodes make them. A derivative has
/// fewer terms than there are nodes, and sums go direction by direction (formulation/points.hpp).
template <TensorElement E, class S>
struct Coefficients<E, S> {
  using Places = Lattice<E>;
  static constexpr int size = Places::size, count = Places::count;
  S c[count][E::dim];  // at Σ b_k sizeᵏ; c[0], the constant, is not used

  PLIANT_HOST_DEVICE static Coefficients of(Nodal<E, S> const& v) {
    using T = builtin_scalar<S>;
    // Along each line of two nodes: half of sum and difference.
    constexpr T scale = E::degree == 1 ? T(1.0 / E::nodes) : T(1);
    Coefficients m;
    unroll<E::nodes>([&](auto a) PLIANT_INLINE {
      constexpr int l = Places::of_node(a);
      for (int i = 0; i < E::dim; ++i) {
        if constexpr (a == 0)
          m.c[l][i] = S(0);
        else if constexpr (E::degree == 1)
          m.c[l][i] = scale * (v(a, i) - v(0, i));
        else
          m.c[l][i] = v(a, i) - v(0, i);
      }
    });
    for_each_missing([&](auto l, auto from, T weight, bool first) PLIANT_INLINE {
      for (int i = 0; i < E::dim; ++i)
        m.c[l][i] = first ? weight * m.c[from][i] : m.c[l][i] + weight * m.c[from][i];
    });
    m.for_each_line([](auto&... values) PLIANT_INLINE { to_monomials(values...); });
    return m;
  }
  PLIANT_HOST_DEVICE static Coefficients zero() {
    Coefficients m;
    for (auto& row : m.c)
      for (S& x : row) x = S(0);
    return m;
  }
  /// ∂v_i/∂ξ_k at point q alone.
  template <class Table>
  PLIANT_HOST_DEVICE Tensor<S, E::dim> gradient(Table const& table, int q) const {
    auto g = Tensor<S, E::dim>::zero();
    for_each_slope([&](auto k, auto b, auto times) PLIANT_INLINE {
      constexpr int lower = b - power(size, k);
      for (int i = 0; i < E::dim; ++i) {
        if constexpr (lower == 0)
          g(i, k) = g(i, k) + c[b][i];
        else
          g(i, k) = g(i, k) + (builtin_scalar<S>(times) * table.monomial[q][lower]) * c[b][i];
      }
    });
    return g;
  }
  /// Its transpose.
  template <class Table>
  PLIANT_HOST_DEVICE void add_divergence(Tensor<S, E::dim> const& t, Table const& table, int q) {
    for_each_slope([&](auto k, auto b, auto times) PLIANT_INLINE {
      constexpr int lower = b - power(size, k);
      for (int i = 0; i < E::dim; ++i) {
        if constexpr (lower == 0)
          c[b][i] = c[b][i] + t(i, k);
        else
          c[b][i] = c[b][i] + (builtin_scalar<S>(times) * table.monomial[q][lower]) * t(i, k);
      }
    });
  }
  PLIANT_HOST_DEVICE Nodal<E, S> per_node() const {
    using T = builtin_scalar<S>;
    Coefficients m = *this;
    for (S& x : m.c[0]) x = S(0);
    m.for_each_line([](auto&... values) PLIANT_INLINE { to_nodes(values...); });
    for_each_missing([&](auto l, auto to, T weight, bool) PLIANT_INLINE {
      for (int i = 0; i < E::dim; ++i) m.c[to][i] = m.c[to][i] + weight * m.c[l][i];
    });
    Nodal<E, S> f;
    unroll<E::nodes>([&](auto a) PLIANT_INLINE {
      constexpr int l = Places::of_node(a);
      for (int i = 0; i < E::dim; ++i) {
        if constexpr (E::degree == 1)
          f(a, i) = T(1.0 / E::nodes) * m.c[l][i];
        else
          f(a, i) = m.c[l][i];
      }
    });
    return f;
  }

 private:
  /// f(k, b, times) where ∂ξ^b/∂ξ_k is not zero: times ξ^(b less one of k).
  template <class Visit>
  PLIANT_HOST_DEVICE static void for_each_slope(Visit const& visit) {
    unroll<E::dim>([&](auto k) PLIANT_INLINE {
      unroll<count>([&](auto b) PLIANT_INLINE {
        constexpr int times = b / power(size, k) % size;
        if constexpr (times > 0) visit(k, b, std::integral_constant<int, times>());
      });
    });
  }
  /// f(l, from, weight, first) for each l without a node, and each node's place with a weight there.
  template <class Visit>
  PLIANT_HOST_DEVICE static void for_each_missing(Visit const& visit) {
    unroll<count>([&](auto l) PLIANT_INLINE {
      if constexpr (Places::node_at(l) < 0) {
        bool first = true;
        unroll<E::nodes>([&](auto a) PLIANT_INLINE {
          constexpr double weight = Places::shape(l, a);
          if constexpr (weight != 0) {
            visit(l, std::integral_constant<int, Places::of_node(a)>(),
                  static_cast<builtin_scalar<S>>(weight), first);
            first = false;
          }
        });
      }
    });
  }
  /// f(values along a line) for all lines, direction after direction.
  template <class Visit>
  PLIANT_HOST_DEVICE void for_each_line(Visit const& visit) {
    unroll<E::dim>([&](auto k) PLIANT_INLINE {
      constexpr int next = power(size, k);
      unroll<count>([&](auto l) PLIANT_INLINE {
        if constexpr (l / next % size == 0) {
          for (int i = 0; i < E::dim; ++i) {
            if constexpr (size == 2)
              visit(c[l][i], c[l + next][i]);
            else
              visit(c[l][i], c[l + next][i], c[l + 2 * next][i]);
          }
        }
      });
    });
  }
  PLIANT_HOST_DEVICE static void to_monomials(S& low, S& high) {
    S const sum = high + low;
    high = high - low;
    low = sum;
  }
  PLIANT_HOST_DEVICE static void to_monomials(S& low, S& middle, S& high) {
    using T = builtin_scalar<S>;
    S const slope = T(0.5) * (high - low);
    high = T(0.5) * (high + low) - middle;
    low = middle;
    middle = slope;
  }
  PLIANT_HOST_DEVICE static void to_nodes(S& even, S& odd) {
    S const sum = even + odd;
    even = even - odd;
    odd = sum;
  }
  PLIANT_HOST_DEVICE static void to_nodes(S& constant, S& linear, S& square) {
    using T = builtin_scalar<S>;
    S const between = constant - square;
    constant = T(0.5) * (square - linear);
    square = T(0.5) * (square + linear);
    linear = between;
  }
};

}  // namespace pliant
