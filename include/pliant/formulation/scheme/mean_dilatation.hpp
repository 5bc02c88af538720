#pragma once

#include <pliant/formulation/points.hpp>
#include <pliant/formulation/scheme/f_bar.hpp>
#include <pliant/formulation/scheme/projection.hpp>

namespace pliant {

namespace detail {

/// (1 + x)^(1/3) − 1, without cancellation.
template <class S>
PLIANT_HOST_DEVICE S cube_root_less_one(S const& x) {
  S const r = exp(log1p(x) / S(3));
  return x / (r * r + r + S(1));
}

}  // namespace detail

template <class F, Geometry G>
struct MeanDilatationStiffness;

/// The points see the mean dilatation of the element, as Projection makes it: W_E = Σ_q w_q det J W(H̄_q); see FBar. In plane
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

  template <class S>
  struct Mean {
    Projection<E, S> onto;
    typename Projection<E, S>::Polynomial dilatation;
  };
  template <class L, class S, class Table>
  PLIANT_HOST_DEVICE static Mean<S> mean(Coefficients<E, S> const& x, Coefficients<E, S> const& v,
                                         Table const& table) {
    using T = builtin_scalar<S>;
    Mean<S> mean;
    auto integrals = Projection<E, S>::Polynomial::zero();
    visit_points<typename F::quadrature, G>(
        [&](int q, T weight, auto const& map, auto const& h) PLIANT_INLINE {
          S const share = map.volume * weight;
          mean.onto.add_weight(share, table, q);
          mean.onto.add(integrals, share * Point<S, linear<L>>::dilatation_of(h), table, q);
        },
        x, v);
    mean.onto.factorise();
    mean.dilatation = mean.onto.nearest(integrals);
    return mean;
  }

  template <class L, class S>
  PLIANT_HOST_DEVICE static S energy(L const& law, Nodal<E, S> const& rest, Nodal<E, S> const& u) {
    using T = builtin_scalar<S>;
    static constexpr auto table = tabulate<E, typename F::quadrature, T>();
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
    auto const mean_of = mean<L>(x, v, table);
    S sum = S(0);
    visit_points<typename F::quadrature, G>(
        [&](int q, T weight, auto const& map, auto const& h) PLIANT_INLINE {
          Point<S, linear<L>> const point(h, mean_of.onto.value(mean_of.dilatation, table, q));
          sum = sum + map.volume * weight * energy_density(at_point(law, q), point.h_bar);
        },
        x, v);
    return sum;
  }

  /// P = r P̄ + (p̄ − r P̄:F/(3 J)) cof F with r = (J̄/J)^(1/3) and p̄ the projection of r P̄:F/(3 J̄).
  template <class L, class S>
  PLIANT_HOST_DEVICE static Nodal<E, S> force(L const& law, Nodal<E, S> const& rest,
                                              Nodal<E, S> const& u) {
    using T = builtin_scalar<S>;
    using Onto = Projection<E, S>;
    static constexpr auto table = tabulate<E, typename F::quadrature, T>();
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
    auto const mean_of = mean<L>(x, v, table);
    auto f = Coefficients<E, S>::zero();
    Coefficients<E, S> slopes[Onto::size];
    for (auto& slope : slopes) slope = Coefficients<E, S>::zero();
    auto pressures = Onto::Polynomial::zero();
    auto const flux = [&](int q, T weight, auto const& map, auto const& h)
                          PLIANT_INLINE -> Tensor<S, dim> {
      S const dilatation = Onto::value(mean_of.dilatation, table, q);
      Point<S, linear<L>> const point(h, dilatation);
      auto const p = stress(at_point(law, q), point.h_bar);
      S const work = point.work(p);
      S const here = linear<L> ? work : work / (S(1) + point.dilatation);
      S const on_mean = linear<L> ? work : work / (S(1) + dilatation);
      auto const slope = -weight * (point.slope() * map.cofactors);
      for (int m = 0; m < Onto::size; ++m)
        slopes[m].add_divergence(Onto::basis(m, table, q) * slope, table, q);
      Onto::add(pressures, map.volume * weight * on_mean, table, q);
      return -weight * (point.pull(p) * map.cofactors) - here * slope;
    };
    add_divergences<typename F::quadrature, G>(f, flux, x, v);
    pressures = mean_of.onto.nearest(pressures);
    auto sum = f.per_node();
    for (int m = 0; m < Onto::size; ++m) sum = sum + pressures[m] * slopes[m].per_node();
    return sum;
  }

  /// By a dual number through the force.
  template <class L, class S>
  PLIANT_HOST_DEVICE static Nodal<E, S> tangent_product(L const& law, Nodal<E, S> const& rest,
                                                        Nodal<E, S> const& u,
                                                        Nodal<E, S> const& du) {
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

  template <class L, class S>
  PLIANT_HOST_DEVICE static Tensor<S, F::nodes * F::dim> stiffness(L const& law,
                                                                   Nodal<E, S> const& rest,
                                                                   Nodal<E, S> const& u) {
    return MeanDilatationStiffness<F, G>::of(law, rest, u);
  }
};

}  // namespace pliant

#include <pliant/formulation/scheme/mean_dilatation_stiffness.hpp>
