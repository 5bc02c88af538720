#pragma once

#include <pliant/formulation/kinematics.hpp>
#include <pliant/quadrature/gauss.hpp>

// The physics of one element, as functions of its nodal values: positions at rest X and
// displacements u. Values in, values out; the scalar S may be float, double, a pack of elements or
// a dual number. Tables are static: a GPU then reads them from its memory, where a local one would be
// built on the stack of every thread.
namespace pliant {

/// The strain energy W_E = Σ_q w_q det J W(H(ξ_q)), J.
template <class F, class L, class S>
PLIANT_HOST_DEVICE S energy(L const& law, Nodal<typename F::element, S> const& rest,
                            Nodal<typename F::element, S> const& u) {
  using E = typename F::element;
  using T = builtin_scalar<S>;
  static constexpr auto table = tabulate<E, typename F::quadrature, T>();
  auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
  S sum = S(0);
  for (int q = 0; q < F::points; ++q) {
    auto const map = RestMap<E, S>::at(x, table, q);
    auto const h = map.gradient(v, table, q);
    sum = sum + map.volume * T(table.weight[q]) * energy_density(law, h);
  }
  return sum;
}

/// The nodal forces F_E = −∂W_E/∂u = −Σ_q w_q P(H) cof J ∂N/∂ξ, N.
template <class F, class L, class S>
PLIANT_HOST_DEVICE Nodal<typename F::element, S> force(L const& law,
                                                       Nodal<typename F::element, S> const& rest,
                                                       Nodal<typename F::element, S> const& u) {
  using E = typename F::element;
  using T = builtin_scalar<S>;
  static constexpr auto table = tabulate<E, typename F::quadrature, T>();
  auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
  auto f = Coefficients<E, S>::zero();
  for (int q = 0; q < F::points; ++q) {
    auto const map = RestMap<E, S>::at(x, table, q);
    auto const h = map.gradient(v, table, q);
    auto const p = stress(law, h);
    f.add_divergence(T(-table.weight[q]) * (p * map.cofactors), table, q);
  }
  return f.per_node();
}

/// The change of the nodal forces under displacements du: −∂²W_E/∂u² du, N.
template <class F, class L, class S>
PLIANT_HOST_DEVICE Nodal<typename F::element, S> force_change(
    L const& law, Nodal<typename F::element, S> const& rest, Nodal<typename F::element, S> const& u,
    Nodal<typename F::element, S> const& du) {
  using E = typename F::element;
  using T = builtin_scalar<S>;
  static constexpr auto table = tabulate<E, typename F::quadrature, T>();
  auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u),
             dv = Coefficients<E, S>::of(du);
  auto df = Coefficients<E, S>::zero();
  for (int q = 0; q < F::points; ++q) {
    auto const map = RestMap<E, S>::at(x, table, q);
    auto const h = map.gradient(v, table, q), dh = map.gradient(dv, table, q);
    auto const dp = stress_change(law, h, dh);
    df.add_divergence(T(-table.weight[q]) * (dp * map.cofactors), table, q);
  }
  return df.per_node();
}

/// The stiffness matrix K = ∂²W_E/∂u², N/m; rows and columns run over (node, direction). Large and
/// seldom called, so kept out of line; constexpr is what lets device code call it.
template <class F, class L, class S>
[[gnu::noinline]] constexpr Tensor<S, F::nodes * F::dim> stiffness(
    L const& law, Nodal<typename F::element, S> const& rest,
    Nodal<typename F::element, S> const& u) {
  constexpr int n = F::nodes * F::dim;
  Tensor<S, n> k;
  for (int column = 0; column < n; ++column) {
    auto du = Nodal<typename F::element, S>::zero();
    du(column / F::dim, column % F::dim) = S(1);
    auto const df = force_change<F>(law, rest, u, du);
    for (int row = 0; row < n; ++row) k(row, column) = -df(row / F::dim, row % F::dim);
  }
  return k;
}

/// The volume of the element at rest, m³ (m² in 2D).
template <Element E, class Q, class S>
PLIANT_HOST_DEVICE S volume(Nodal<E, S> const& rest) {
  using T = builtin_scalar<S>;
  static constexpr auto table = tabulate<E, Q, T>();
  auto const x = Coefficients<E, S>::of(rest);
  S sum = S(0);
  for (int q = 0; q < table.count; ++q)
    sum = sum + RestMap<E, S>::at(x, table, q).volume * T(table.weight[q]);
  return sum;
}

/// The share of the element's volume that each node carries by row sums, ∫ N_a dV. Its quadrature is
/// the element's own, so that a change of law or force quadrature leaves masses alone.
template <Element E, class S>
PLIANT_HOST_DEVICE Vector<S, E::nodes> nodal_volumes(Nodal<E, S> const& rest) {
  using T = builtin_scalar<S>;
  static constexpr auto table = tabulate<E, Gauss<2>, T>();
  auto const x = Coefficients<E, S>::of(rest);
  auto m = Vector<S, E::nodes>::zero();
  for (int q = 0; q < table.count; ++q) {
    S const v = RestMap<E, S>::at(x, table, q).volume * T(table.weight[q]);
    for (int a = 0; a < E::nodes; ++a) m[a] = m[a] + v * T(table.shape[q][a]);
  }
  return m;
}

}  // namespace pliant
