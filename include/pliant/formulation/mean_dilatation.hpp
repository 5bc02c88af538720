#pragma once

#include <pliant/formulation/kinematics.hpp>
#include <pliant/quadrature/f_bar.hpp>

namespace pliant {

namespace detail {

/// (1 + x)^(1/3) − 1, without cancellation.
template <class S>
PLIANT_HOST_DEVICE S cube_root_less_one(S const& x) {
  S const r = exp(log1p(x) / S(3));
  return x / (r * r + r + S(1));
}

}  // namespace detail

/// Each point sees the mean dilatation of the element: W_E = Σ_q w_q det J W(H̄_q); see FBar. In plane
/// strain too F̄ is that of space, with F̄₃₃ = (J̄/J)^(1/3): deviators of the plane alone would leave all
/// conformal maps free.
template <class F, Geometry G>
struct MeanDilatation {
  using E = typename F::element;
  static constexpr int dim = F::dim;

  /// A point's deformation and what replaces it.
  template <class S, bool Linear>
  struct Point {
    Tensor<S, dim> h;
    Tensor<S, 3> h_bar;
    S dilatation;   // J − 1, or tr H
    S root = S(1);  // (J̄/J)^(1/3)

    PLIANT_HOST_DEVICE static S dilatation_of(Tensor<S, dim> const& h) {
      if constexpr (Linear)
        return trace(h);
      else
        return determinant_less_one(h);
    }
    PLIANT_HOST_DEVICE Point(Tensor<S, dim> const& h_here, S const& mean)
        : h(h_here), h_bar(in_space(h_here)), dilatation(dilatation_of(h_here)) {
      S more = S(0);  // on the diagonal
      if constexpr (Linear) {
        more = (mean - dilatation) / S(3);
      } else {
        more = detail::cube_root_less_one((mean - dilatation) / (S(1) + dilatation));
        root = S(1) + more;
        h_bar = root * h_bar;
      }
      for (int i = 0; i < 3; ++i) h_bar(i, i) = h_bar(i, i) + more;
    }
    /// ∂(dilatation)/∂F: cof F, or I.
    PLIANT_HOST_DEVICE Tensor<S, dim> slope() const {
      auto c = Linear ? Tensor<S, dim>::zero() : cofactor_less_identity(h);
      for (int i = 0; i < dim; ++i) c(i, i) = c(i, i) + S(1);
      return c;
    }
    /// What the stress p̄ at H̄ does when the dilatation alone changes, over 1 + dilatation.
    PLIANT_HOST_DEVICE S work(Tensor<S, 3> const& p) const {
      if constexpr (Linear)
        return trace(p) / S(3);
      else
        return root * (dot(p, in_space(h)) + trace(p)) / S(3);
    }
    /// r P̄, as far as it acts in the body's dimensions.
    PLIANT_HOST_DEVICE Tensor<S, dim> pull(Tensor<S, 3> const& p) const {
      Tensor<S, dim> part;
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) part(i, j) = root * p(i, j);
      return part;
    }
  };
  template <class L>
  static constexpr bool linear =
      EnergyIn<std::remove_cvref_t<decltype(at_point(std::declval<L const&>(), 0))>,
               StrainInvariants>;

  template <class L, class S, class Table>
  PLIANT_HOST_DEVICE static S mean(Coefficients<E, S> const& x, Coefficients<E, S> const& v,
                                   Table const& table, S& volume) {
    using T = builtin_scalar<S>;
    S sum = S(0);
    volume = S(0);
    for (int q = 0; q < F::points; ++q) {
      auto const map = RestMap<E, S, G>::at(x, table, q);
      S const share = map.volume * T(table.weight[q]);
      sum = sum + share * Point<S, linear<L>>::dilatation_of(map.gradient(v, table, q));
      volume = volume + share;
    }
    return sum / volume;
  }

  template <class L, class S>
  PLIANT_HOST_DEVICE static S energy(L const& law, Nodal<E, S> const& rest, Nodal<E, S> const& u) {
    using T = builtin_scalar<S>;
    static constexpr auto table = tabulate<E, typename F::quadrature, T>();
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
    S volume, sum = S(0);
    S const mean_dilatation = mean<L>(x, v, table, volume);
    for (int q = 0; q < F::points; ++q) {
      auto const map = RestMap<E, S, G>::at(x, table, q);
      Point<S, linear<L>> const point(map.gradient(v, table, q), mean_dilatation);
      sum = sum + map.volume * T(table.weight[q]) * energy_density(at_point(law, q), point.h_bar);
    }
    return sum;
  }

  /// P = r P̄ + (p̄ − r P̄:F/(3 J)) cof F with r = (J̄/J)^(1/3) and p̄ the mean of r P̄:F/(3 J̄).
  template <class L, class S>
  PLIANT_HOST_DEVICE static Nodal<E, S> force(L const& law, Nodal<E, S> const& rest,
                                              Nodal<E, S> const& u) {
    using T = builtin_scalar<S>;
    static constexpr auto table = tabulate<E, typename F::quadrature, T>();
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
    S volume;
    S const mean_dilatation = mean<L>(x, v, table, volume);
    S const scale = linear<L> ? S(1) : S(1) + mean_dilatation;
    auto f = Coefficients<E, S>::zero(), slopes = Coefficients<E, S>::zero();
    S pressure = S(0);
    for (int q = 0; q < F::points; ++q) {
      auto const map = RestMap<E, S, G>::at(x, table, q);
      Point<S, linear<L>> const point(map.gradient(v, table, q), mean_dilatation);
      auto const p = stress(at_point(law, q), point.h_bar);
      S const work = point.work(p);
      auto const slope = point.slope();
      S const here = linear<L> ? work : work / (S(1) + point.dilatation);
      f.add_divergence(T(-table.weight[q]) * ((point.pull(p) - here * slope) * map.cofactors),
                       table, q);
      slopes.add_divergence(T(-table.weight[q]) * (slope * map.cofactors), table, q);
      pressure = pressure + map.volume * T(table.weight[q]) * work;
    }
    return f.per_node() + (pressure / (volume * scale)) * slopes.per_node();
  }

  /// By a dual number through the force.
  template <class L, class S>
  PLIANT_HOST_DEVICE static Nodal<E, S> force_change(L const& law, Nodal<E, S> const& rest,
                                                     Nodal<E, S> const& u, Nodal<E, S> const& du) {
    Nodal<E, Dual<S, 1>> x, v;
    for (int a = 0; a < E::nodes; ++a)
      for (int i = 0; i < dim; ++i) {
        x(a, i) = rest(a, i);
        v(a, i).value = u(a, i);
        v(a, i).derivative[0] = du(a, i);
      }
    auto const f = force(law, x, v);
    Nodal<E, S> df;
    for (int a = 0; a < E::nodes; ++a)
      for (int i = 0; i < dim; ++i) df(a, i) = f(a, i).derivative[0];
    return df;
  }
};

}  // namespace pliant
