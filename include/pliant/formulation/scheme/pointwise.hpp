#pragma once

#include <pliant/formulation/kinematics.hpp>

namespace pliant {

/// Each point of the rule by itself: W_E = Σ_q w_q det J W(H(ξ_q)).
template <class F, Geometry G>
struct Pointwise {
  using E = typename F::element;

  template <class L, class S>
  PLIANT_HOST_DEVICE static S energy(L const& law, Nodal<E, S> const& rest, Nodal<E, S> const& u) {
    using T = builtin_scalar<S>;
    static constexpr auto table = tabulate<E, typename F::quadrature, T>();
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
    S sum = S(0);
    for (int q = 0; q < F::points; ++q) {
      auto const map = RestMap<E, S, G>::at(x, table, q);
      auto const h = map.gradient(v, table, q);
      sum = sum + map.volume * T(table.weight[q]) * energy_density(at_point(law, q), h);
    }
    return sum;
  }

  template <class L, class S>
  PLIANT_HOST_DEVICE static Nodal<E, S> force(L const& law, Nodal<E, S> const& rest,
                                              Nodal<E, S> const& u) {
    using T = builtin_scalar<S>;
    static constexpr auto table = tabulate<E, typename F::quadrature, T>();
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
    auto f = Coefficients<E, S>::zero();
    for (int q = 0; q < F::points; ++q) {
      auto const map = RestMap<E, S, G>::at(x, table, q);
      auto const h = map.gradient(v, table, q);
      auto const p = stress(at_point(law, q), h);
      f.add_divergence(T(-table.weight[q]) * (p * map.cofactors), table, q);
    }
    return f.per_node();
  }

  template <class L, class S>
  PLIANT_HOST_DEVICE static Nodal<E, S> tangent_product(L const& law, Nodal<E, S> const& rest,
                                                        Nodal<E, S> const& u,
                                                        Nodal<E, S> const& du) {
    using T = builtin_scalar<S>;
    static constexpr auto table = tabulate<E, typename F::quadrature, T>();
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u),
               dv = Coefficients<E, S>::of(du);
    auto df = Coefficients<E, S>::zero();
    for (int q = 0; q < F::points; ++q) {
      auto const map = RestMap<E, S, G>::at(x, table, q);
      auto const h = map.gradient(v, table, q), dh = map.gradient(dv, table, q);
      auto const dp = stress_tangent_product(at_point(law, q), h, dh);
      df.add_divergence(T(-table.weight[q]) * (dp * map.cofactors), table, q);
    }
    return df.per_node();
  }
};

}  // namespace pliant
