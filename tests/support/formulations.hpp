#pragma once

#include <string>

#include "support/backends.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/meshes.hpp"

// The formulations that a suite runs over: every pair of element and law, of element and quadrature,
// and of each of them with each backend and precision, but not their full product.
namespace pliant::test {

template <class... Fs>
struct List {};

template <class B, class F>
struct Case {
  using backend = B;
  using T = typename B::scalar;
  using formulation = F;
  using element = typename F::element;
};

using LinearFormulations =
    List<Formulation<Tri3, Gauss<1>, Hooke>, Formulation<Tri3, Gauss<2>, SaintVenantKirchhoff>,
         Formulation<Tri3, Gauss<1>, NeoHookean>, Formulation<Quad4, Gauss<2>, Hooke>,
         Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>,
         Formulation<Quad4, Gauss<3>, NeoHookean>, Formulation<Tet4, Gauss<2>, Hooke>,
         Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>, Formulation<Tet4, Gauss<1>, NeoHookean>,
         Formulation<Hex8, Gauss<2>, Hooke>, Formulation<Hex8, Gauss<3>, SaintVenantKirchhoff>,
         Formulation<Hex8, Gauss<2>, NeoHookean>>;
/// For what has been seen over all formulations on another backend.
using FewLinearFormulations =
    List<Formulation<Tri3, Gauss<1>, NeoHookean>, Formulation<Quad4, Gauss<2>, Hooke>,
         Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>,
         Formulation<Hex8, Gauss<2>, NeoHookean>>;

using QuadraticFormulations =
    List<Formulation<Tri6, Gauss<2>, NeoHookean>, Formulation<Tri6, Gauss<4>, Hooke>,
         Formulation<Quad8, Gauss<3>, SaintVenantKirchhoff>,
         Formulation<Quad9, Gauss<3>, NeoHookean>, Formulation<Tet10, Gauss<2>, NeoHookean>,
         Formulation<Tet10, Gauss<3>, SaintVenantKirchhoff>, Formulation<Hex20, Gauss<3>, Hooke>,
         Formulation<Hex27, Gauss<3>, NeoHookean>>;
using FewQuadraticFormulations =
    List<Formulation<Tri6, Gauss<2>, NeoHookean>, Formulation<Quad8, Gauss<3>, Hooke>,
         Formulation<Tet10, Gauss<2>, SaintVenantKirchhoff>>;

/// The cells of mixed meshes, and quadratures that are more than points.
using SpecialFormulations =
    List<Formulation<Wedge6, Gauss<2>, NeoHookean>, Formulation<Pyramid5, Gauss<2>, NeoHookean>,
         Formulation<Quad4, OnePoint, NeoHookean>, Formulation<Hex8, OnePoint, Hooke>,
         Formulation<Hex8, OnePoint, SaintVenantKirchhoff>,
         Formulation<Quad4, FBar<Gauss<2>>, NeoHookean>, Formulation<Quad4, FBar<Gauss<2>>, Hooke>,
         Formulation<Hex8, FBar<Gauss<2>>, NeoHookean>,
         Formulation<Quad9, FBar<Gauss<3>>, NeoHookean>,
         Formulation<Tet10, FBar<Gauss<3>>, SaintVenantKirchhoff>>;
using FewSpecialFormulations =
    List<Formulation<Wedge6, Gauss<2>, Hooke>, Formulation<Quad4, OnePoint, NeoHookean>,
         Formulation<Quad4, FBar<Gauss<2>>, NeoHookean>>;

/// λ = 3 Pa, μ = 2 Pa, ρ = 1.5 kg/m³.
inline constexpr Elastic soft{5.2, 0.3, 1.5};

/// The parameters in the suites of a law that does not take them from `soft`: `law`, and the `values` of
/// each element.
template <class L>
struct Sample {};

}  // namespace pliant::test

#if defined(LAW_FORMULATIONS)
#include "support/law_formulations.hpp"
#endif

namespace pliant::test {

// The build compiles a suite once for each list; see tests/CMakeLists.txt.
#if defined(LAW_FORMULATIONS)
using AllFormulations = LawFormulations;
using FewFormulations = FewLawFormulations;
#elif defined(QUADRATIC_FORMULATIONS)
using AllFormulations = QuadraticFormulations;
using FewFormulations = FewQuadraticFormulations;
#elif defined(SPECIAL_FORMULATIONS)
using AllFormulations = SpecialFormulations;
using FewFormulations = FewSpecialFormulations;
#elif defined(FEW_FORMULATIONS_ALONE)
using AllFormulations = FewLinearFormulations;
using FewFormulations =
    List<Formulation<Tri3, Gauss<1>, NeoHookean>, Formulation<Hex8, Gauss<2>, NeoHookean>>;
#else
using AllFormulations = LinearFormulations;
using FewFormulations = FewLinearFormulations;
#endif

template <class B>
using formulations_on =
    std::conditional_t<std::same_as<B, MainBackend>, AllFormulations, FewFormulations>;

/// The name of a type, as the compiler has it, without namespaces.
template <class U>
std::string type_name() {
  std::string const all = __PRETTY_FUNCTION__;
  auto const first = all.find("U = ") + 4;
  std::string name = all.substr(first, all.find_first_of(";]", first) - first);
  for (std::string const part : {"pliant::", "<double>"})
    for (auto at = name.find(part); at != name.npos; at = name.find(part))
      name.erase(at, part.size());
  return name;
}
template <class F>
std::string law_name() {
  return type_name<typename F::template law<double>>();
}
template <class B>
std::string backend_name() {
  std::string name = B::name();
  name += sizeof(typename B::scalar) == 4 ? "<float>" : "<double>";
  return name;
}
template <class F>
std::string formulation_name() {
  constexpr bool f_bar = has_mean_dilatation<typename F::quadrature>;
  return std::string(F::element::name()) + ", " + std::to_string(F::points) +
         (f_bar ? " points with F-bar, " : " points, ") + law_name<F>();
}

/// Calls visit(B) for each backend of a list, each in a section of its own.
template <class Bs, class Visit>
void on_each_backend(Visit const& visit) {
  auto const one = [&]<class B>(B const* /* type */) {
    DYNAMIC_SECTION(backend_name<B>()) { visit(B{}); }
  };
  [&]<class... B>(std::tuple<B...> const*) {
    (one(static_cast<B const*>(nullptr)), ...);
  }(static_cast<Bs const*>(nullptr));
}

/// Calls visit(Case<B, F>) for each formulation of a list on one backend.
template <class B, class... Fs, class Visit>
void on_each_of(List<Fs...>, Visit const& visit) {
  auto const one = [&]<class F>(Case<B, F> c) {
    DYNAMIC_SECTION(backend_name<B>() << ", " << formulation_name<F>()) { visit(c); }
  };
  (one(Case<B, Fs>{}), ...);
}
/// Calls visit(Case<B, F>) for each backend of a list: all formulations on the main backend, few on the
/// others.
template <class Bs, class Visit>
void on_each_formulation(Visit const& visit) {
  [&]<class... B>(std::tuple<B...> const*) {
    (on_each_of<B>(formulations_on<B>{}, visit), ...);
  }(static_cast<Bs const*>(nullptr));
}
/// The same with few formulations on all of them.
template <class Bs, class Visit>
void on_few_formulations(Visit const& visit) {
  [&]<class... B>(std::tuple<B...> const*) {
    (on_each_of<B>(FewFormulations{}, visit), ...);
  }(static_cast<Bs const*>(nullptr));
}

/// A group with the law and the values of its sample.
template <class F>
Group<F> sample_group() {
  using S = Sample<typename F::template law<double>>;
  Group<F> group;
  if constexpr (requires { S::law; }) group.law = S::law;
  if constexpr (requires { S::values; }) group.values = {S::values};
  return group;
}
/// A body of one formulation.
template <class F, Backend B, class M>
auto body_of(B const& backend, M const& mesh, Elastic const& material = soft) {
  return Body{backend, mesh, material, sample_group<F>()};
}

/// Those of a list on one element, as a tuple of groups.
template <class E, class F>
auto group_if_on() {
  if constexpr (std::same_as<typename F::element, E>)
    return std::tuple{sample_group<F>()};
  else
    return std::tuple{};
}
template <class E, class... Fs>
auto groups_on(List<Fs...>) {
  return std::tuple_cat(group_if_on<E, Fs>()...);
}
/// A body all of whose elements are in one group, with groups for all formulations on this element of the list, so that
/// the compiler makes one body for them.
template <class F, class L, Backend B, class M>
auto body_among(B const& backend, M const& mesh) {
  auto body = std::apply(
      [&](auto const&... group) {
        return Body{backend, mesh, soft, group...};
      },
      groups_on<typename F::element>(L{}));
  std::vector<Index> all(mesh.template elements<typename F::element>().size());
  for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
  body.template assign<F>(all);
  return body;
}

/// The same among those that on_each_formulation visits.
template <class F, Backend B, class M>
auto body_among_all(B const& backend, M const& mesh) {
  return body_among<F, formulations_on<B>>(backend, mesh);
}

/// The law of a body of one formulation at a point of any element, at rest so far.
template <class F, class TheBody>
auto law_at_a_point(TheBody const& body) {
  auto const law = body.parts().template law_of<F>();
  if constexpr (element_values<F> > 0) {
    Vector<double, element_values<F>> values;
    for (int k = 0; k < element_values<F>; ++k)
      values[k] = Sample<typename F::template law<double>>::values[static_cast<std::size_t>(k)];
    return law.at(values);
  } else if constexpr (internal_variables_of<F> > 0) {
    return law.over(0).after(Vector<double, internal_variables_of<F> / F::points>::zero());
  } else {
    return law;
  }
}

/// Whether a law takes rotations for strains.
template <class F>
inline constexpr bool small_strain =
    std::same_as<typename F::template law<double>, Hooke<double>> ||
    std::same_as<typename F::template law<double>, PlaneStress<Hooke>::law<double>>;

template <class TheBody>
double total_mass(TheBody const& body) {
  double sum = 0;
  for (double m : body.parts().layout.mass_list()) sum += m;
  return sum;
}

/// The forces of a body at given displacements.
template <class TheBody>
auto forces_at(TheBody& body, std::vector<Point<TheBody::dim>> const& u) {
  body.set_displacements(u);
  return body.forces();
}

}  // namespace pliant::test
