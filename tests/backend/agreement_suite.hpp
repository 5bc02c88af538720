#pragma once

#include "support/flat.hpp"
#include "support/formulations.hpp"

// The serial backend in double precision is the oracle of the others.
namespace pliant::test::agreement_suite {

#if defined(LAW_FORMULATIONS) && defined(_OPENMP) && !defined(__CUDACC__)
/// Those of which the backend knows more than a functor: values, internal variables, thickness, branches. The test
/// openmp/law_packs holds the functors themselves to numbers.
using Compared = List<Formulation<Tet4, Gauss<1>, HolzapfelGasserOgden>,
                      Formulation<Tri3, Gauss<1>, PerElement<NeoHookean>::law>,
                      Formulation<Quad4, Gauss<2>, PlaneStress<NeoHookean>::law>,
                      Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::law>,
                      Formulation<Tet4, Gauss<1>, KelvinVoigt<StableNeoHookean>::law>,
                      Formulation<Tet4, Gauss<1>, Corotated>>;
#else
using Compared = AllFormulations;
#endif

template <class F, class... Fs>
constexpr bool is_in(List<Fs...>) {
  return (std::same_as<F, Fs> || ...);
}
/// The list that has a formulation.
template <class F>
using ListOf = std::conditional_t<is_in<F>(Compared{}), Compared, FewFormulations>;

template <class B>
using compared_on = std::conditional_t<std::same_as<B, MainBackend>, Compared, FewFormulations>;

/// Calls visit(Case<B, F>) for each backend in each precision that is not the oracle itself.
template <class Visit>
void on_each_compared(Visit const& visit) {
  auto const one = [&]<class B>(B const* /* type */) {
    if constexpr (!std::same_as<B, Reference<double>> || std::same_as<B, MainBackend>)
      on_each_of<B>(compared_on<B>{}, visit);
  };
  [&]<class... B>(std::tuple<B...> const*) {
    (one(static_cast<B const*>(nullptr)), ...);
  }(static_cast<AllPairs const*>(nullptr));
}

/// The largest component of a force that any one element makes.
template <class F, class TheBody>
double largest_element_force(TheBody const& body, FieldOf<F::dim> const& u) {
  using E = typename F::element;
  double m = 0;
  for (auto const& nodes : body.mesh().template elements<E>()) {
    Nodal<E, double> own;
    for (int a = 0; a < E::nodes; ++a)
      for (int k = 0; k < E::dim; ++k)
        own(a, k) = u[static_cast<std::size_t>(nodes[static_cast<std::size_t>(a)])]
                     [static_cast<std::size_t>(k)];
    auto const f = force<F>(prepared<F>(law_at_a_point<F>(body)), nodal(body.mesh(), nodes), own);
    for (int a = 0; a < E::nodes; ++a)
      for (int k = 0; k < E::dim; ++k) m = std::max(m, std::abs(f(a, k)));
  }
  return m;
}

TEST_CASE("forces, tangents and energies are those of the serial backend", "[backend]") {
  on_each_compared([]<class B, class F>(Case<B, F>) {
    using T = typename B::scalar;
    constexpr bool single = std::same_as<T, float>;
    // More elements than a patch holds; strains of about 0.01.
    constexpr bool six_per_cell = F::element::cell::corners < 6;
    int const n = F::dim == 2 ? 56 : six_per_cell ? 8 : 13;
    auto const mesh = distorted_mesh<typename F::element>(n);
    auto const u = rounded<T>(plus(uniform(mesh.nodes, Random(1).tensor<F::dim>(0.005)), 1,
                                   Random(2).field<F::dim>(mesh.nodes.size(), 0.005 / n)));
    auto const du = rounded<T>(Random(3).field<F::dim>(mesh.nodes.size(), 1.0));
    auto body = body_among<F, compared_on<B>>(B{}, mesh);
    auto oracle = body_among<F, ListOf<F>>(Reference<double>{}, mesh);
    auto const expected = forces_at(oracle, u);

    auto const f = forces_at(body, u);

    double const scale = largest_element_force<F>(oracle, u);
    CHECK(largest(expected) > 1e-2 * scale);
    CHECK(difference(f, expected) < (single ? 1e-5 : 1e-13) * scale);
    CHECK(strain_energy(body) == Approx(strain_energy(oracle)).epsilon(single ? 1e-5 : 1e-13));
    // The tangent is of order one however small the strain: rounding alone.
    auto const df = tangent_product(oracle, u, du);
    CHECK(difference(tangent_product(body, u, du), df) < (single ? 1e-5 : 1e-13) * largest(df));
    CHECK((body.parts().layout.mass_list() == oracle.parts().layout.mass_list()));
  });
}

TEST_CASE("single precision of each backend is that of the serial one", "[backend]") {
  on_each_formulation<Backends<float>>([]<class B, class F>(Case<B, F>) {
    int const n = F::dim == 2 ? 20 : 8;
    auto const mesh = distorted_mesh<typename F::element>(n);
    auto const u = Random(2).field<F::dim>(mesh.nodes.size(), 0.05 / n);
    auto body = body_among<F, FewFormulations>(B{}, mesh);
    auto serial = body_among<F, FewFormulations>(Reference<float>{}, mesh);

    auto const f = forces_at(body, u), expected = forces_at(serial, u);

    // Sums in another order, products contracted or not: some units in the last place.
    CHECK(difference(f, expected) <
          16 * double{std::numeric_limits<float>::epsilon()} * largest(expected));
  });
}

TEST_CASE("steps are those of the serial backend", "[backend]") {
  on_each_backend<Backends<double>>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, NeoHookean>;
    auto const run = [](auto const& on) {
      auto const mesh = distorted_mesh<Tri3>(40);
      auto body = body_of<F>(on, mesh);
      body.clamp(mesh.boundary("left"));
      body.drive(mesh.boundary("right"), [](double t) { return Point<2>{t / 4, 0}; });
      body.set_gravity({0, -1});
      body.set_load(17, {0.001, 0});
      body.set_damping(0.5);
      CentralDifference step{{.step = 4e-3}};
      step(body, 100);
      return body.displacements();
    };

    auto const u = run(backend), expected = run(Reference<double>{});

    CHECK(largest(expected) > 0.05);
    CHECK(difference(u, expected) < 1e-12 * largest(expected));
  });
}

}  // namespace pliant::test::agreement_suite
