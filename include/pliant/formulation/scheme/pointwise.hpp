#pragma once

#include <pliant/formulation/point_stiffness.hpp>
#include <pliant/formulation/points.hpp>

namespace pliant {

/// Each point of the rule by itself: W_E = Σ_q w_q det J W(H(ξ_q)).
template <class F, Geometry G>
struct Pointwise {
  using E = typename F::element;

  using Q = typename F::quadrature;

  template <class L, class S>
  PLIANT_HOST_DEVICE static S energy(L const& law, Nodal<E, S> const& rest, Nodal<E, S> const& u) {
    using T = builtin_scalar<S>;
    S sum = S(0);
    visit_points<Q, G>(
        [&](int q, T weight, auto const& map, auto const& h) PLIANT_INLINE {
          sum = sum + map.volume * weight * energy_density(at_point(law, q), h);
        },
        Coefficients<E, S>::of(rest), Coefficients<E, S>::of(u));
    return sum;
  }

  /// −w P cof J: the forces are its divergence.
  template <class L, class S, class T>
  PLIANT_HOST_DEVICE static Tensor<S, F::dim> flux(L const& law, int q, T weight,
                                                   RestMap<E, S, G> const& map,
                                                   Tensor<S, F::dim> const& h) {
    return -weight * (stress(at_point(law, q), h) * map.cofactors);
  }
  /// −w (∂P/∂H : δH) cof J.
  template <class L, class S, class T>
  PLIANT_HOST_DEVICE static Tensor<S, F::dim> flux(L const& law, int q, T weight,
                                                   RestMap<E, S, G> const& map,
                                                   Tensor<S, F::dim> const& h,
                                                   Tensor<S, F::dim> const& dh) {
    return -weight * (stress_tangent_product(at_point(law, q), h, dh) * map.cofactors);
  }

  template <class L, class S>
  PLIANT_HOST_DEVICE static Nodal<E, S> force(L const& law, Nodal<E, S> const& rest,
                                              Nodal<E, S> const& u) {
    return divergence(law, rest, u);
  }
  template <class L, class S>
  PLIANT_HOST_DEVICE static Nodal<E, S> tangent_product(L const& law, Nodal<E, S> const& rest,
                                                        Nodal<E, S> const& u,
                                                        Nodal<E, S> const& du) {
    return divergence(law, rest, u, du);
  }

  /// K_(ai)(bk) = Σ_q w_q det J Σ_jl ∂N_a/∂X_j ∂P_ij/∂H_kl ∂N_b/∂X_l.
  template <class L, class S>
  PLIANT_HOST_DEVICE static Tensor<S, F::nodes * F::dim> stiffness(L const& law,
                                                                   Nodal<E, S> const& rest,
                                                                   Nodal<E, S> const& u) {
    using T = builtin_scalar<S>;
    constexpr int dim = F::dim, nodes = F::nodes;
    static constexpr auto table = tabulate<E, Q, T>();
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
    auto k = Tensor<S, nodes * dim>::zero();
    for (int q = 0; q < F::points; ++q) {
      auto const map = RestMap<E, S, G>::at(x, table, q);
      auto const h = map.gradient(v, table, q);
      auto const gradient = detail::rest_gradients<E>(map, table, q);
      S const weight = map.inverse_volume * T(table.weight[q]);
      for (int direction = 0; direction < dim; ++direction) {
        Tensor<S, dim> tangent[dim];  // ∂P/∂H_(direction)l
        for (int l = 0; l < dim; ++l) {
          auto dh = Tensor<S, dim>::zero();
          dh(direction, l) = weight;
          tangent[l] = stress_tangent_product(at_point(law, q), h, dh);
        }
        for (int i = 0; i < dim; ++i) {
          Matrix<S, dim, nodes> pull;  // Σ_l ∂P_ij/∂H_(direction)l ∂N_b/∂X_l
          for (int j = 0; j < dim; ++j)
            for (int b = 0; b < nodes; ++b) {
              pull(j, b) = tangent[0](i, j) * gradient(0, b);
              for (int l = 1; l < dim; ++l)
                pull(j, b) = pull(j, b) + tangent[l](i, j) * gradient(l, b);
            }
          for (int a = 0; a < nodes; ++a)
            for (int b = 0; b < nodes; ++b) {
              S sum = gradient(0, a) * pull(0, b);
              for (int j = 1; j < dim; ++j) sum = sum + gradient(j, a) * pull(j, b);
              S& entry = k(dim * a + i, dim * b + direction);
              entry = entry + sum;
            }
        }
      }
    }
    return k;
  }

 private:
  template <class L, class S, class... V>
  PLIANT_HOST_DEVICE static Nodal<E, S> divergence(L const& law, Nodal<E, S> const& rest,
                                                   V const&... v) {
    auto sum = Coefficients<E, S>::zero();
    add_divergences<Q, G>(
        sum,
        [&](int q, auto weight, auto const& map, auto const&... gradients)
            PLIANT_INLINE { return flux(law, q, weight, map, gradients...); },
        Coefficients<E, S>::of(rest), Coefficients<E, S>::of(v)...);
    return sum.per_node();
  }
};

}  // namespace pliant
