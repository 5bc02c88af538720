#include "support/laws.hpp"

// Where laws end.
namespace pliant::test::limits_test {

TEST_CASE("Gent's energy goes to infinity at the limit of stretch", "[law]") {
  // Uniaxial and isochoric: Ī₁ − 3 = l² + 2/l − 3.
  double const limit = 10, locked = 3.5260158210927;
  Gent<double> const law{2, limit, 5};
  REQUIRE(locked * locked + 2 / locked - 3 == Approx(limit).epsilon(1e-8));
  auto const at = [](double l) {
    return diagonal<3>({l - 1, 1 / std::sqrt(l) - 1, 1 / std::sqrt(l) - 1});
  };
  double before = 0;
  for (double closeness : {0.5, 0.1, 1e-2, 1e-4, 1e-6}) {
    auto const h = at(locked - closeness);
    double const stiffness = stress_tangent_product(law, h, diagonal<3>({1, 0, 0}))(0, 0);
    CHECK(std::isfinite(energy_density(law, h)));
    CHECK(stiffness > 3 * before);
    before = stiffness;
  }
  CHECK(std::isnan(energy_density(law, at(locked + 1e-6))));
  CHECK(std::isnan(stress(law, at(locked + 1e-6))(0, 0)));  // so that steps do not go on there
}

TEST_CASE("Arruda-Boyce stiffens as the chains near their locking stretch", "[law]") {
  auto const slack = ArrudaBoyce<double>::from({5.2, 0.3, 1}, 100);
  auto const tight = ArrudaBoyce<double>::from({5.2, 0.3, 1}, 1.5);
  auto const neo_hookean = IsochoricNeoHookean<double>::from({5.2, 0.3, 1});
  auto const h = diagonal<3>({1, -0.3, -0.3});
  CHECK(stress(slack, h)(0, 0) == Approx(stress(neo_hookean, h)(0, 0)).epsilon(1e-3));
  CHECK(stress(tight, h)(0, 0) > 1.5 * stress(neo_hookean, h)(0, 0));
}

TEST_CASE("laws of the logarithm end where an element is flat", "[law]") {
  auto const flat = diagonal<3>({-1, 0, 0}), inverted = diagonal<3>({-1.5, 0, 0});
  CHECK(energy_density(law_of_section_6<NeoHookean>, flat) == INFINITY);
  CHECK(std::isnan(energy_density(law_of_section_6<NeoHookean>, inverted)));
  CHECK_FALSE(std::isfinite(energy_density(law_of_section_6<SimoNeoHookean>, flat)));
  // Before that it grows beyond bounds: I₁ → 2, Ī₁ as J^(−2/3).
  for (double l : {1e-3, 1e-6, 1e-9}) {
    auto const& [mu, bulk] = law_of_section_6<SimoNeoHookean>;
    double const W = energy_density(law_of_section_6<SimoNeoHookean>, diagonal<3>({l - 1, 0, 0}));
    double const shape = mu / 2 * (2 * std::pow(l, -2.0 / 3) - 3);
    CHECK(W == Approx(shape - bulk / 4 * (1 + 2 * std::log(l))).epsilon(1e-5));
  }
  CHECK(std::isnan(energy_density(law_of_section_6<SimoNeoHookean>, inverted)));
  CHECK(std::isnan(energy_density(law_of_section_6<Ogden>, inverted)));
}

TEST_CASE("the stable neo-Hookean law pushes flat and inverted elements back", "[law]") {
  auto const law = law_of_section_6<StableNeoHookean>;
  for (double l : {0.1, 0.0, -0.5, -1.0}) {
    auto const p = stress(law, diagonal<3>({l - 1, 0, 0}));
    CHECK(p(0, 0) == Approx(2 * (l - 1) + 5 * (l - 1)));  // P₁₁ = μ (l − 1) + (λ + μ)(l − 1)
    CHECK(std::abs(p(0, 1)) == 0);
  }
}

TEST_CASE("laws split into shape and volume keep volume changes free of shear", "[law]") {
  // A dilatation by l: P = κ (J − 1) J/l I, of Simo's form κ/2 (J − 1/J) J/l I.
  double const l = 1.3, J = l * l * l;
  auto const h = diagonal<3>({l - 1, l - 1, l - 1});
  auto const pressure = [&](auto const& law) { return stress(law, h)(0, 0); };
  CHECK(pressure(IsochoricNeoHookean<double>{2, 5}) == Approx(5 * (J - 1) * J / l));
  CHECK(pressure(MooneyRivlin<double>{.75, .25, 5}) == Approx(5 * (J - 1) * J / l));
  CHECK(pressure(Yeoh<double>{1, .2, .1, 5}) == Approx(5 * (J - 1) * J / l));
  CHECK(pressure(Gent<double>{2, 10, 5}) == Approx(5 * (J - 1) * J / l));
  CHECK(pressure(ArrudaBoyce<double>{2, 1.5, 5}) == Approx(5 * (J - 1) * J / l));
  CHECK(pressure(Ogden<double>{{1, 1, 1}, {1, 2, -3}, 5}) == Approx(5 * (J - 1) * J / l));
  CHECK(pressure(SimoNeoHookean<double>{2, 5}) == Approx(5 * (J - 1 / J) / 2 * J / l));
}

}  // namespace pliant::test::limits_test
