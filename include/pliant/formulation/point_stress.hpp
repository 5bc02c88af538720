#pragma once

#include <pliant/formulation/physics.hpp>

// The stresses that nodal forces are integrated from, for those who look at them.
namespace pliant {

namespace detail {
template <class L>
PLIANT_HOST_DEVICE L const& without_modulus(L const& law) {
  return law;
}
template <class L, class T>
PLIANT_HOST_DEVICE L const& without_modulus(WithModulus<L, T> const& law) {
  return law.law;
}

/// Laws of small strain, whose stress is conjugate to sym H.
template <class L>
concept OfSmallStrain = EnergyIn<L, StrainInvariants> || requires(L const& law) {
  requires EnergyIn<std::remove_cvref_t<decltype(law.solid)>, StrainInvariants>;
};
}  // namespace detail

/// The law at quadrature point q of an element, without what a scheme keeps beside it.
template <class L>
PLIANT_HOST_DEVICE decltype(auto) point_law(L const& law, int q) {
  return at_point(detail::without_modulus(law), q);
}

/// Calls visit(q, volume, H) at each point of a formulation's rule, with the point's rest volume (m³).
template <class F, class S, class Visit>
PLIANT_HOST_DEVICE void for_each_point_of(Nodal<typename F::element, S> const& rest,
                                          Nodal<typename F::element, S> const& u,
                                          Visit const& visit) {
  using E = typename F::element;
  using T = builtin_scalar<S>;
  visit_points<typename F::quadrature>([&](int q, T weight, auto const& map, auto const& h)
                                           PLIANT_INLINE { visit(q, map.volume * weight, h); },
                                       Coefficients<E, S>::of(rest), Coefficients<E, S>::of(u));
}

/// Calls visit(q, volume, H, P) at each point of a formulation's rule, with the rest volume of the point (m³),
/// the displacement gradient, and the first Piola-Kirchhoff stress (Pa) whose virtual work the nodal forces
/// are: F_E = −Σ_q volume P ∂N/∂X. Under OnePoint that is the mean stress, without the control of
/// hourglasses; under FBar the stress with the element's mean pressure.
template <class F, class L, class S, class Visit>
PLIANT_HOST_DEVICE void for_each_stress(L const& law, Nodal<typename F::element, S> const& rest,
                                        Nodal<typename F::element, S> const& u,
                                        Visit const& visit) {
  using E = typename F::element;
  if constexpr (std::same_as<typename F::quadrature, OnePoint>) {
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
    auto const mean = MeanGradient<E, S>::of(x);
    auto const h = mean(v);
    visit(0, mean.volume, h, stress(point_law(law, 0), h));
  } else if constexpr (has_mean_dilatation<typename F::quadrature>) {
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
    using T = builtin_scalar<S>;
    using Scheme = MeanDilatation<F, Geometry::isoparametric>;
    using Onto = Projection<E, S>;
    constexpr bool linear = Scheme::template linear<L>;
    using At = typename Scheme::template Point<S, linear>;
    static constexpr auto table = tabulate<E, typename F::quadrature, T>();
    auto const mean = Scheme::template mean<L>(x, v, table);
    auto pressures = Onto::Polynomial::zero();
    for (int q = 0; q < F::points; ++q) {
      auto const map = RestMap<E, S>::at(x, table, q);
      S const dilatation = Onto::value(mean.dilatation, table, q);
      At const point(map.gradient(v, table, q), dilatation);
      S const work = point.work(stress(at_point(law, q), point.h_bar));
      Onto::add(pressures,
                map.volume * T(table.weight[q]) * (linear ? work : work / (S(1) + dilatation)),
                table, q);
    }
    pressures = mean.onto.nearest(pressures);
    for (int q = 0; q < F::points; ++q) {
      auto const map = RestMap<E, S>::at(x, table, q);
      At const point(map.gradient(v, table, q), Onto::value(mean.dilatation, table, q));
      auto const p = stress(at_point(law, q), point.h_bar);
      S const own = linear ? point.work(p) : point.work(p) / (S(1) + point.dilatation);
      visit(q, map.volume * T(table.weight[q]), point.h,
            point.pull(p) + (Onto::value(pressures, table, q) - own) * point.slope());
    }
  } else {
    for_each_point_of<F>(rest, u,
                         [&](int q, S const& volume, Tensor<S, F::dim> const& h)
                             PLIANT_INLINE { visit(q, volume, h, stress(at_point(law, q), h)); });
  }
}

}  // namespace pliant
