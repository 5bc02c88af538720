#pragma once

#include <string>

#include <pliant/pliant.hpp>

// The formulations that are timed: every element with every law.
namespace pliant::bench {

/// The quadrature that integrates an element's forces in practice: as many points per direction as nodes, on simplices
/// as many as the degree asks for.
template <Element E>
using UsualPoints = Gauss<E::degree + (SimplexCell<typename E::cell> ? 0 : 1)>;

template <Element E, template <class> class L>
using Usual = Formulation<E, UsualPoints<E>, L>;

inline constexpr char const* element_names[] = {"Tri3", "Quad4", "Tet4", "Hex8"};

template <class F>
constexpr int element_number() {
  return F::dim == 2 ? F::nodes - 3 : F::nodes == 4 ? 2 : 3;
}
template <class F>
constexpr int law_number() {
  using L = typename F::template law<double>;
  return std::same_as<L, Hooke<double>> ? 0 : std::same_as<L, SaintVenantKirchhoff<double>> ? 1 : 2;
}
template <class F>
std::string law_name() {
  constexpr char const* names[] = {"Hooke", "SaintVenantKirchhoff", "NeoHookean"};
  return internal_variables_of<F> > 0 ? "Prony" : names[law_number<F>()];
}
template <class T>
std::string precision_name() {
  return sizeof(T) == 4 ? "float" : "double";
}

/// Half of all triples (element, law, precision), such that every pair of two of them occurs.
template <class F, class T>
constexpr bool in_pairwise_choice() {
  return (element_number<F>() + law_number<F>() + (sizeof(T) == 8 ? 0 : 1)) % 2 == 0;
}

/// Calls visit.operator()<F>() for each element with each law.
template <class Visit>
void on_each_formulation(Visit const& visit) {
  auto const laws_of = [&]<class E>(E) {
    visit.template operator()<Usual<E, Hooke>>();
    visit.template operator()<Usual<E, SaintVenantKirchhoff>>();
    visit.template operator()<Usual<E, NeoHookean>>();
  };
  laws_of(Tri3{});
  laws_of(Quad4{});
  laws_of(Tet4{});
  laws_of(Hex8{});
}

/// What the bodies are made of: λ = 3 Pa, μ = 2 Pa, ρ = 1.5 kg/m³.
inline constexpr Elastic soft{5.2, 0.3, 1.5};

/// The law of a formulation in the shape that kernels take.
template <class T, class F>
GroupLaws<T, F> soft_laws() {
  return {{prepared<F>(law_cast<T>(F::template law<double>::from(soft)))}};
}

}  // namespace pliant::bench
