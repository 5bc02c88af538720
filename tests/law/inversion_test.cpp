#include <pliant/law/decorators/per_element.hpp>
#include <pliant/law/decorators/plane_stress.hpp>
#include <pliant/law/decorators/viscosity.hpp>

#include "support/inverted_states.hpp"

#if defined(_OPENMP)
#include <pliant/openmp/pack.hpp>
#endif

// What laws are where elements are flat or inverted, J ≤ 0.
namespace pliant::test::inversion_test {

static_assert(takes_inversion<Hooke<double>> && takes_inversion<SaintVenantKirchhoff<double>>);
static_assert(takes_inversion<StableNeoHookean<float>> && takes_inversion<Corotated<double>>);
static_assert(takes_inversion<Fung<double>> && takes_inversion<Guccione<double>>);
static_assert(!takes_inversion<NeoHookean<double>> && !takes_inversion<Ogden<float>>);
static_assert(!takes_inversion<HolzapfelGasserOgden<double>>);
static_assert(takes_inversion<PerElement<Hooke>::law<double>>);
static_assert(!takes_inversion<PerElement<Yeoh>::law<double>>);
static_assert(takes_inversion<KelvinVoigt<StableNeoHookean>::law<double>>);
static_assert(!takes_inversion<Prony<NeoHookean>::law<double>>);
static_assert(takes_inversion<PlaneStress<Hooke>::law<double>>);
static_assert(!takes_inversion<PlaneStress<StableNeoHookean>::law<double>>);
static_assert(!takes_inversion<PlaneStress<Guccione>::law<double>>);

/// What a law is in each state: all finite where it takes inversion, nothing where it does not.
template <class T, int Dim, class L>
void check_states(L const& law, std::vector<Tensor<double, Dim>> const& states) {
  int const expected = takes_inversion<L> ? 1 : 0, entries = expected * Dim * Dim;
  Random random(42);
  for (std::size_t k = 0; k < states.size(); ++k) {
    INFO("state " << k << " in " << Dim << "D, " << 8 * sizeof(T) << " bits");
    auto const h = in_precision<T>(states[k]);
    CHECK(count_finite(energy_density(law, h)) == expected);
    CHECK(count_finite(stress(law, h)) == entries);
    auto const dh = in_precision<T>(random.tensor<Dim>(1));
    CHECK(count_finite(stress_tangent_product(law, h, dh)) == entries);
  }
}

TEST_CASE("inverted states are refused by laws for J > 0, and taken by others", "[law]") {
  on_each_maker([](auto make, char const* name, Kind) {
    DYNAMIC_SECTION(name) {
      check_states<double>(make(1.0), inverted_states<2>());
      check_states<double>(make(1.0), inverted_states<3>());
      check_states<float>(make(1.0f), inverted_states<3>());
    }
  });
}

TEST_CASE("flat states are refused by laws for J > 0, and taken by others", "[law]") {
  on_each_maker([](auto make, char const* name, Kind) {
    DYNAMIC_SECTION(name) {
      check_states<double>(make(1.0), flat_states<2>());
      check_states<double>(make(1.0), flat_states<3>());
      check_states<float>(make(1.0f), flat_states<3>());
    }
  });
}

TEST_CASE("a half turn about an axis is no inversion", "[law]") {
  auto const turned = gradient_of<3>(diagonal<3>({-1, -1, 1}));
  on_each_maker([&](auto make, char const* name, Kind kind) {
    if (!kind.objective) return;
    DYNAMIC_SECTION(name) {
      CHECK(energy_density(make(1.0), turned) == Approx(0).margin(1e-14));
      CHECK(largest<3>(stress(make(1.0), turned)) < 1e-13);
    }
  });
}

TEST_CASE("sheets of all laws but Hooke's refuse inversion in their plane", "[law]") {
  auto const states = inverted_states<2>();
  auto const check = [&]<template <class> class L>(L<double> const& solid) {
    check_states<double>(typename PlaneStress<L>::template law<double>{{solid}}, states);
  };
  check(law_of_section_6<Hooke>);
  check(law_of_section_6<SaintVenantKirchhoff>);
  check(law_of_section_6<StableNeoHookean>);
  check(law_of_section_6<NeoHookean>);
  check(law_of_section_6<Yeoh>);
}

TEST_CASE("viscous laws refuse inversion where their elastic law does", "[law]") {
  auto const check = [&]<template <class> class L>(L<double> const& elastic) {
    typename KelvinVoigt<L>::template law<double> const dashpot{elastic, 0.1};
    typename Prony<L>::template law<double> const branch{elastic, {0.5}, {1}};
    int const entries = takes_inversion<L<double>> ? 9 : 0;
    for (auto const& h : inverted_states<3>()) {
      auto const voigt = dashpot.over(0.1).after(Vector<double, 6>::zero());
      CHECK(count_finite(energy_density(voigt, h)) == entries / 9);
      CHECK(count_finite(stress(voigt, h)) == entries);
      auto const maxwell = branch.over(0.1).after(Vector<double, 12>::zero());
      CHECK(count_finite(energy_density(maxwell, h)) == entries / 9);
      CHECK(count_finite(stress(maxwell, h)) == entries);
    }
  };
  check(law_of_section_6<StableNeoHookean>);
  check(law_of_section_6<IsochoricNeoHookean>);
}

/// With powers of J that are finite for J < 0.
template <class T>
struct InversePowers {
  T mu;
  template <class S>
  PLIANT_HOST_DEVICE S energy(CauchyGreenInvariants<S> const& i) const {
    return mu / 2 * i.D / square(positive_or_nan(1 + i.J_minus_1));
  }
};

TEST_CASE("a user's law for J > 0 refuses inversion", "[law]") {
  static_assert(!takes_inversion<InversePowers<double>>);
  check_states<double>(InversePowers<double>{2}, inverted_states<3>());
  check_states<float>(InversePowers<float>{2}, flat_states<3>());
}

#if defined(_OPENMP)
/// Lane 0 is at rest; the others, of a pack each, are inverted or flat.
template <class T, class L>
void check_lanes(L const& law) {
  using P = Pack<T>;
  auto states = inverted_states<3>();
  for (auto const& h : flat_states<3>()) states.push_back(h);
  int const expected = takes_inversion<L> ? 1 : 0, entries = 9 * expected;
  Random random(43);
  for (std::size_t k = 0; k < states.size(); ++k) {
    INFO("state " << k << ", " << 8 * sizeof(T) << " bits");
    Tensor<P, 3> h, dh;
    auto const direction = random.tensor<3>(1);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        h(i, j) = P(states[k](i, j));
        h(i, j).v[0] = 0;
        dh(i, j) = P(direction(i, j));
      }
    auto const w = energy_density(law, h);
    auto const p = stress(law, h), dp = stress_tangent_product(law, h, dh);
    int stresses = 0, changes = 0, at_rest = count_finite(w[0]);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        at_rest += count_finite(p(i, j)[0], dp(i, j)[0]);
        stresses += count_finite(p(i, j)[P::lanes - 1]);
        changes += count_finite(dp(i, j)[P::lanes - 1]);
      }
    CHECK(at_rest == 1 + 9 + 9);
    CHECK(count_finite(w[P::lanes - 1]) == expected);
    CHECK(stresses == entries);
    CHECK(changes == entries);
  }
}

TEST_CASE("packs refuse inverted elements lane by lane, as laws for J > 0 do", "[law]") {
  on_each_maker([](auto make, char const* name, Kind) {
    DYNAMIC_SECTION(name) {
      check_lanes<double>(make(1.0));
      check_lanes<float>(make(1.0f));
    }
  });
}
#endif

}  // namespace pliant::test::inversion_test
