#pragma once

#include <concepts>
#include <type_traits>

#include <pliant/law/elastic.hpp>
#include <pliant/law/invariants/fibre_invariants.hpp>
#include <pliant/law/invariants/green_strain.hpp>
#include <pliant/law/invariants/invariants.hpp>
#include <pliant/law/invariants/isochoric_invariants.hpp>
#include <pliant/law/invariants/principal_stretches.hpp>
#include <pliant/law/parameters.hpp>
#include <pliant/law/takes_inversion.hpp>

// A law is an aggregate template of its parameters, all of type T, with its strain energy density
// written once, in a set of invariants of law/invariants or in H = F − I:
//
//   template <class T>
//   struct MyLaw {
//     T mu, lambda;  // Pa
//     template <class S>
//     PLIANT_HOST_DEVICE S energy(CauchyGreenInvariants<S> const& i) const { return ...; }
//     static MyLaw from(Elastic const& m) { return {T(m.lame_mu()), T(m.lame_lambda())}; }
//   };
//
// An energy of two parts, each in a set of its own, writes two functions `energy`: they add.
// S may be T, a pack of elements or a dual number of either: write `select`, never `if`, on values,
// and integers or T(0.5) for constants. `from` is needed only where the law takes its parameters
// from an `Elastic`, `void check() const` only where some parameters are impossible: it throws Error.
// `static constexpr bool takes_inversion = true` says that it is defined for J ≤ 0 too.
// Stress and tangent follow by differentiation.
namespace pliant {

/// The energy is written in this set of invariants.
template <class L, template <class> class Invariants>
concept EnergyIn = requires(L const& law, Invariants<Dual<double, 1>> const& i) {
  { law.energy(i) } -> std::convertible_to<Dual<double, 1>>;
};
/// The energy is written in the displacement gradient H = F − I, always 3×3.
template <class L>
concept EnergyInGradient = requires(L const& law, Tensor<Dual<double, 1>, 3> const& h) {
  { law.energy(h) } -> std::convertible_to<Dual<double, 1>>;
};
/// The energy is that of a plane body, in its displacement gradient, 2×2.
template <class L>
concept EnergyInPlane = requires(L const& law, Tensor<Dual<double, 1>, 2> const& h) {
  { law.energy(h) } -> std::convertible_to<Dual<double, 1>>;
};

namespace detail {

template <class... Sets>
struct SetList {
  static constexpr int size = sizeof...(Sets);
};
template <class L, class List, class... Chosen>
struct ChooseSets {
  using type = SetList<Chosen...>;
};
template <class L, class Set, class... Sets, class... Chosen>
struct ChooseSets<L, SetList<Set, Sets...>, Chosen...>
    : ChooseSets<L, SetList<Sets...>, Chosen...> {};
template <class L, class Set, class... Sets, class... Chosen>
  requires requires(L const& law, Set const& i) {
    { law.energy(i) } -> std::convertible_to<Dual<double, 1>>;
  }
struct ChooseSets<L, SetList<Set, Sets...>, Chosen...>
    : ChooseSets<L, SetList<Sets...>, Chosen..., Set> {};

/// The sets of invariants in which a law writes its energy, or the parts of it.
template <class L, int Dim, class V = Dual<double, 1>>
using sets_of =
    typename ChooseSets<L,
                        SetList<FibreStretch<V>, FibreStrain<V>, StrainInvariants<V>,
                                VolumeChange<V>, CauchyGreenInvariants<V>, GreenInvariants<V>,
                                PrincipalInvariants<V>, IsochoricInvariants<V>, MooneyInvariants<V>,
                                GreenStrain<V, Dim>, PrincipalStretches<V>>>::type;

}  // namespace detail

/// A strain energy density that knows three dimensions.
template <class L>
concept SolidLaw = detail::sets_of<L, 3>::size > 0 || EnergyInGradient<L>;
/// A strain energy density and its parameters, at one point of one material.
template <class L>
concept PointLaw = SolidLaw<L> || EnergyInPlane<L>;

/// A law some of whose parameters differ between elements: `at(values)`, of `element_values`
/// numbers that a body keeps per element, is the law of that element. The values may be a pack of
/// elements.
template <class L>
concept LawPerElement = requires(L const& law, Vector<double, L::element_values> const& values) {
  { law.at(values) } -> PointLaw;
};
/// A law whose quadrature points keep internal variables, `internal_variables<d>` each in d dimensions.
/// `over(step)` is what a time step (s) makes of it; then `after(internal)` is the law at a point with
/// those, `advanced(internal, H)` what the point keeps once it has come to H, and `equilibrated(H)` what
/// it keeps if it has always been there. See KelvinVoigt and Prony.
template <class L>
concept LawWithInternalVariables =
    requires(L const& law, Vector<double, L::template internal_variables<3>> const& internal,
             Tensor<double, 3> const& h) {
      { law.over(1.0).after(internal) } -> PointLaw;
      {
        law.over(1.0).advanced(internal, h)
      } -> std::same_as<Vector<double, L::template internal_variables<3>>>;
      {
        law.over(1.0).equilibrated(h)
      } -> std::same_as<Vector<double, L::template internal_variables<3>>>;
    };
/// Whether a law's stress depends on how fast it deforms, so that after a step, once the point keeps what it has
/// come to, `over(0)` has another stress than the step had: a dashpot's is gone. The law says so itself.
template <class L>
inline constexpr bool depends_on_rate = requires { requires L::depends_on_rate; };
/// What a formulation can be made of.
template <class L>
concept Law = PointLaw<L> || LawPerElement<L> || LawWithInternalVariables<L>;

/// The law at quadrature point q of an element.
template <class L>
PLIANT_HOST_DEVICE decltype(auto) at_point(L const& law, [[maybe_unused]] int q) {
  if constexpr (requires { law.at_point(q); })
    return law.at_point(q);
  else
    return (law);
}

/// A law whose parameters follow from an `Elastic`.
template <class L>
concept LawFromElastic = Law<L> && requires(Elastic const& m) {
  { L::from(m) } -> std::same_as<L>;
};

/// The displacement gradient in 3D of a plane strain state.
template <class S>
PLIANT_HOST_DEVICE Tensor<S, 3> in_space(Tensor<S, 3> const& h) {
  return h;
}
template <class S>
PLIANT_HOST_DEVICE Tensor<S, 3> in_space(Tensor<S, 2> const& h) {
  return {{{h(0, 0), h(0, 1), S(0)}, {h(1, 0), h(1, 1), S(0)}, {S(0), S(0), S(0)}}};
}

namespace detail {

template <class Set, class L, class S, int Dim>
PLIANT_HOST_DEVICE S energy_in(L const& law, Tensor<S, Dim> const& h) {
  using Family = typename Set::template rebind<S>;
  if constexpr (requires { Family::energy_of(law, h); })
    return Family::energy_of(law, h);
  else
    return law.energy(Family::of(h));
}
template <class Set, class L, class S, int Dim>
PLIANT_HOST_DEVICE Tensor<S, Dim> stress_in(L const& law, Tensor<S, Dim> const& h) {
  using Family = typename Set::template rebind<S>;
  if constexpr (requires { Family::stress_of(law, h); }) {
    return Family::stress_of(law, h);
  } else if constexpr (MakesStressOfKnownZeros<Family, Dim>) {
    return Family::stress(slopes_knowing_zeros<S>(law, Family::of(h)), h);
  } else {
    return Family::stress(slopes_of<S>(law, Family::of(h)), h);
  }
}

template <class L, class S, int Dim>
PLIANT_HOST_DEVICE auto energy_of_gradient(L const& law, Tensor<S, Dim> const& h) {
  if constexpr (EnergyInGradient<L>) {
    return law.energy(in_space(h));
  } else {
    static_assert(Dim == 2, "this law is that of a plane body: give it two dimensions");
    return law.energy(h);
  }
}
template <class L, class S, int Dim>
PLIANT_HOST_DEVICE Tensor<S, Dim> stress_by_gradient(L const& law, Tensor<S, Dim> const& h) {
  using Variable = Dual<S, Dim * Dim>;
  Tensor<Variable, Dim> variables;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) variables(i, j) = Variable::variable(h(i, j), i * Dim + j);
  Variable const w = energy_of_gradient(law, variables);
  Tensor<S, Dim> p;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) p(i, j) = w.derivative[i * Dim + j];
  return p;
}

template <class... Sets, class L, class S, int Dim>
PLIANT_HOST_DEVICE S sum_of_energies(SetList<Sets...>, L const& law, Tensor<S, Dim> const& h) {
  return (energy_in<Sets>(law, h) + ...);
}
template <class... Sets, class L, class S, int Dim>
PLIANT_HOST_DEVICE Tensor<S, Dim> sum_of_stresses(SetList<Sets...>, L const& law,
                                                  Tensor<S, Dim> const& h) {
  return (stress_in<Sets>(law, h) + ...);
}

template <class Sets>
inline constexpr bool without_roots = false;
template <template <class> class Set, class V>
inline constexpr bool without_roots<SetList<Set<V>>> =
    std::same_as<Set<V>, StrainInvariants<V>> || std::same_as<Set<V>, CauchyGreenInvariants<V>> ||
    std::same_as<Set<V>, GreenInvariants<V>>;
}  // namespace detail

/// Whether the energy is a function of one set of two polynomials in H, so that the stress takes few
/// operations.
template <class L>
inline constexpr bool has_two_invariants = false;
template <PointLaw L>
inline constexpr bool has_two_invariants<L> = detail::without_roots<detail::sets_of<L, 3>>;

/// Strain energy per rest volume (J/m³) at the displacement gradient h.
template <PointLaw L, class S, int Dim>
PLIANT_HOST_DEVICE S energy_density(L const& law, Tensor<S, Dim> const& h) {
  using Sets = detail::sets_of<L, Dim>;
  if constexpr (Sets::size > 0)
    return detail::sum_of_energies(Sets{}, law, h);
  else
    return detail::energy_of_gradient(law, h);
}

/// The first Piola-Kirchhoff stress P = ∂W/∂F (Pa) at the displacement gradient h. A law may write
/// it by hand as `stress(h)`; otherwise duals on the invariants, or on H, derive it.
template <PointLaw L, class S, int Dim>
PLIANT_HOST_DEVICE Tensor<S, Dim> stress(L const& law, Tensor<S, Dim> const& h) {
  using Sets = detail::sets_of<L, Dim>;
  if constexpr (requires { law.stress(h); })
    return law.stress(h);
  else if constexpr (Sets::size > 0)
    return detail::sum_of_stresses(Sets{}, law, h);
  else
    return detail::stress_by_gradient(law, h);
}

/// The change of stress dP = ∂P/∂F : dH, by a one-component dual through the stress.
template <PointLaw L, class S, int Dim>
PLIANT_HOST_DEVICE Tensor<S, Dim> stress_tangent_product(L const& law, Tensor<S, Dim> const& h,
                                                         Tensor<S, Dim> const& dh) {
  Tensor<Dual<S, 1>, Dim> variables;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) {
      variables(i, j).value = h(i, j);
      variables(i, j).derivative[0] = dh(i, j);
    }
  Tensor<Dual<S, 1>, Dim> const p = stress(law, variables);
  Tensor<S, Dim> dp;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) dp(i, j) = p(i, j).derivative[0];
  return dp;
}

}  // namespace pliant
