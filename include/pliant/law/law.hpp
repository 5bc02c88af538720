#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <utility>

#include <pliant/law/elastic.hpp>
#include <pliant/law/invariants.hpp>

// A law is an aggregate template of its parameters, all of type T, with its strain energy density
// written once:
//
//   template <class T>
//   struct MyLaw {
//     T mu, lambda;  // Pa
//     template <class S>
//     PLIANT_HOST_DEVICE S energy(CauchyGreenInvariants<S> const& i) const { return ...; }
//     static MyLaw from(Elastic const& m) { return {T(m.lame_mu()), T(m.lame_lambda())}; }
//   };
//
// S may be T, a pack of elements or a dual number of either: write `select`, never `if`, on values,
// and integers or T(0.5) for constants. `from` is needed only where the law takes its parameters
// from an `Elastic`. Stress and tangent follow by differentiation.
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
/// A strain energy density and its parameters.
template <class L>
concept Law = EnergyIn<L, StrainInvariants> || EnergyIn<L, CauchyGreenInvariants> ||
              EnergyIn<L, GreenInvariants> || EnergyInGradient<L>;

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

template <class Family, class L, class S, int Dim>
PLIANT_HOST_DEVICE Tensor<S, Dim> stress_by_invariants(L const& law, Tensor<S, Dim> const& h) {
  Family const i = Family::of(h);
  typename Family::template rebind<Dual<S, Family::count>> variables;
  for (int k = 0; k < Family::count; ++k) variables[k] = Dual<S, Family::count>::variable(i[k], k);
  Dual<S, Family::count> const w = law.energy(variables);
  Family slopes;
  for (int k = 0; k < Family::count; ++k) slopes[k] = w.derivative[k];
  return Family::stress(slopes, h);
}

template <class L, class S, int Dim>
PLIANT_HOST_DEVICE Tensor<S, Dim> stress_by_gradient(L const& law, Tensor<S, Dim> const& h) {
  using Variable = Dual<S, Dim * Dim>;
  Tensor<Variable, Dim> variables;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) variables(i, j) = Variable::variable(h(i, j), i * Dim + j);
  Variable const w = law.energy(in_space(variables));
  Tensor<S, Dim> p;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) p(i, j) = w.derivative[i * Dim + j];
  return p;
}

}  // namespace detail

/// Strain energy per rest volume (J/m³) at the displacement gradient h.
template <Law L, class S, int Dim>
PLIANT_HOST_DEVICE S energy_density(L const& law, Tensor<S, Dim> const& h) {
  if constexpr (EnergyIn<L, StrainInvariants>)
    return law.energy(StrainInvariants<S>::of(h));
  else if constexpr (EnergyIn<L, CauchyGreenInvariants>)
    return law.energy(CauchyGreenInvariants<S>::of(h));
  else if constexpr (EnergyIn<L, GreenInvariants>)
    return law.energy(GreenInvariants<S>::of(h));
  else
    return law.energy(in_space(h));
}

/// The first Piola-Kirchhoff stress P = ∂W/∂F (Pa) at the displacement gradient h. A law may write
/// it by hand as `stress(h)`; otherwise duals on the invariants, or on H, derive it.
template <Law L, class S, int Dim>
PLIANT_HOST_DEVICE Tensor<S, Dim> stress(L const& law, Tensor<S, Dim> const& h) {
  if constexpr (requires { law.stress(h); })
    return law.stress(h);
  else if constexpr (EnergyIn<L, StrainInvariants>)
    return detail::stress_by_invariants<StrainInvariants<S>>(law, h);
  else if constexpr (EnergyIn<L, CauchyGreenInvariants>)
    return detail::stress_by_invariants<CauchyGreenInvariants<S>>(law, h);
  else if constexpr (EnergyIn<L, GreenInvariants>)
    return detail::stress_by_invariants<GreenInvariants<S>>(law, h);
  else
    return detail::stress_by_gradient(law, h);
}

/// The change of stress dP = ∂P/∂F : dH, by a one-component dual through the stress.
template <Law L, class S, int Dim>
PLIANT_HOST_DEVICE Tensor<S, Dim> stress_change(L const& law, Tensor<S, Dim> const& h,
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

namespace detail {
/// One T, the `I`th of a list.
template <class T, std::size_t I>
T const& one_of_many();
template <class L, class T, std::size_t... I>
constexpr bool made_of(std::index_sequence<I...>) {
  return requires { L{one_of_many<T, I>()...}; };  // braces refuse a T for a member that is no T
}
}  // namespace detail

/// The parameters of a law as a list of numbers.
template <template <class> class L, class T>
auto parameters(L<T> const& law) {
  constexpr std::size_t count = sizeof(L<T>) / sizeof(T);
  static_assert(sizeof(L<T>) == count * sizeof(T) &&
                    detail::made_of<L<T>, T>(std::make_index_sequence<count>()),
                "every member of a law L<T> must be of type T, or an array of T");
  return std::bit_cast<std::array<T, count>>(law);
}

/// The same law with its parameters in another precision.
template <class To, template <class> class L, class From>
L<To> law_cast(L<From> const& law) {
  auto const from = parameters(law);
  std::array<To, from.size()> to;
  for (std::size_t k = 0; k < from.size(); ++k) to[k] = static_cast<To>(from[k]);
  static_assert(sizeof(L<To>) == sizeof(to), "a law L<T> has the same members for each T");
  return std::bit_cast<L<To>>(to);
}

}  // namespace pliant
