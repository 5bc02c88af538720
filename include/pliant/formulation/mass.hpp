#pragma once

#include <pliant/formulation/points.hpp>
#include <pliant/quadrature/gauss.hpp>
#include <pliant/quadrature/lobatto.hpp>

// Volumes, and how they go to nodes. Their quadrature is the element's own, so that a change of law or
// of force quadrature leaves masses alone.
namespace pliant {

/// The volume of the element at rest, m³ (m² in 2D).
template <Element E, class Q, class S>
PLIANT_HOST_DEVICE S volume(Nodal<E, S> const& rest) {
  using T = builtin_scalar<S>;
  S sum = S(0);
  visit_points<Q>([&](int, T weight, auto const& map)
                      PLIANT_INLINE { sum = sum + map.volume * weight; },
                  Coefficients<E, S>::of(rest));
  return sum;
}

/// Exact for ∫ N_a N_b dV where sides are straight.
template <Element E>
using MassQuadrature = Gauss<SimplexCell<typename E::cell> ? 2 * E::degree : E::degree + 1>;

/// ∫ N_a Σ_b N_b x_b dV: the consistent mass of unit density times values at nodes.
template <Element E, class S>
PLIANT_HOST_DEVICE Nodal<E, S> volume_product(Nodal<E, S> const& rest, Nodal<E, S> const& x) {
  using T = builtin_scalar<S>;
  static constexpr auto table = tabulate<E, MassQuadrature<E>, T>();
  auto const c = Coefficients<E, S>::of(rest);
  auto product = Nodal<E, S>::zero();
  for (int q = 0; q < table.count; ++q) {
    S const v = RestMap<E, S>::at(c, table, q).volume * T(table.weight[q]);
    for (int k = 0; k < E::dim; ++k) {
      S value = S(0);
      for (int b = 0; b < E::nodes; ++b) value = value + T(table.shape[q][b]) * x(b, k);
      value = v * value;
      for (int a = 0; a < E::nodes; ++a)
        product(a, k) = product(a, k) + T(table.shape[q][a]) * value;
    }
  }
  return product;
}

/// The share of the element's volume that each node carries: positive, and exact in total.
template <Element E, class S>
PLIANT_HOST_DEVICE Vector<S, E::nodes> nodal_volumes(Nodal<E, S> const& rest) {
  using T = builtin_scalar<S>;
  using Q = std::conditional_t<E::lumping == Lumping::nodal, Lobatto<3>, MassQuadrature<E>>;
  static constexpr auto table = tabulate<E, Q, T>();
  auto const x = Coefficients<E, S>::of(rest);
  auto m = Vector<S, E::nodes>::zero();
  for (int q = 0; q < table.count; ++q) {
    S const v = RestMap<E, S>::at(x, table, q).volume * T(table.weight[q]);
    for (int a = 0; a < E::nodes; ++a) {
      T const n = table.shape[q][a];
      m[a] = m[a] + v * (E::lumping == Lumping::diagonal ? n * n : n);
    }
  }
  if constexpr (E::lumping != Lumping::row_sum) {
    S sum = m[0];
    for (int a = 1; a < E::nodes; ++a) sum = sum + m[a];
    m = (volume<E, MassQuadrature<E>>(rest) / sum) * m;
  }
  return m;
}

}  // namespace pliant
