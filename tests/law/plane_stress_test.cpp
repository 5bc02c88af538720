#include <pliant/law/decorators/per_element.hpp>

#include "law/sheets.hpp"

namespace pliant::test::plane_stress_test {

static_assert(LawFromElastic<PlaneStress<Hooke>::law<double>>);
static_assert(LawFromElastic<PlaneStress<NeoHookean>::law<float>>);
static_assert(EnergyInPlane<PlaneStress<Ogden>::law<double>>);
static_assert(PlaneStress<Guccione>::law<double>::element_values == 3);
static_assert(LawPerElement<PlaneStress<PerElement<NeoHookean>::law>::law<double>>);

TEST_CASE("a sheet bears no stress across its thickness", "[law]") {
  on_each_sheet<Ask::energy_and_stress>([](AnySheet const& sheet) {
    Random random(17);
    for (int state = 0; state < 50; ++state) {
      auto const h = random_state<2>(random);
      auto const in_3d = sheet.in_3d(h), p = sheet.solid.stress(in_3d);
      auto const in_plane = sheet.law.stress(h);
      double const rounding = 2e-14 * (1 + largest<2>(in_plane));
      CHECK(std::abs(p(2, 2)) < rounding);
      CHECK(in_3d(2, 2) > -0.9);
      CHECK(sheet.law.energy(h) == Approx(sheet.solid.energy(in_3d)).epsilon(1e-13));
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) CHECK(std::abs(p(i, j) - in_plane(i, j)) < rounding);
    }
  });
}

TEST_CASE("the stress of a sheet is the derivative of its energy", "[law]") {
  on_each_sheet<Ask::energy_and_stress>([](AnySheet const& sheet) {
    Random random(18);
    for (int state = 0; state < 10; ++state) {
      auto const h = random_state<2>(random), along = random.tensor<2>(1);
      auto const p = sheet.law.stress(h);
      double const power =
          derivative([&](double t) { return sheet.law.energy(h + t * along); }, 2e-3);
      CHECK(dot(p, along) == Approx(power).epsilon(0).margin(1e-8 * (1 + largest<2>(p))));
    }
  });
}

TEST_CASE("all sheets are Hooke's at small strain", "[law]") {
  on_each_sheet<Ask::energy_and_stress>([](AnySheet const& sheet) {
    if (!sheet.law.kind.like_hooke) return;
    // E/(1 − ν²) (e + ν (tr e I − e)) with E = 5.2, ν = 0.3.
    Random random(19);
    for (int state = 0; state < 10; ++state) {
      auto const h = random.tensor<2>(1e-6);
      auto const e = symmetric_part(h);
      auto expected = (1 - 0.3) * e;
      for (int i = 0; i < 2; ++i) expected(i, i) += 0.3 * trace(e);
      CHECK(largest<2>(sheet.law.stress(h) - 5.2 / (1 - 0.09) * expected) < 1e-10);
    }
  });
}

TEST_CASE("a sheet takes the values of an element for its law", "[law]") {
  PlaneStress<Guccione>::law<double> const sheets{{Guccione<double>{2, 4, 1, 2, 5}}};
  auto const h = diagonal<2>({0.2, -0.1, 0});
  auto const p = pliant::stress(sheets.at(Vector<double, 3>{{{1}, {0}, {0}}}), h);
  auto const turned =
      pliant::stress(sheets.at(Vector<double, 3>{{{0}, {2}, {0}}}), diagonal<2>({-0.1, 0.2, 0}));
  CHECK(p(0, 0) == Approx(turned(1, 1)).epsilon(1e-12));
  CHECK(p(1, 1) == Approx(turned(0, 0)).epsilon(1e-12));
  CHECK(p(0, 0) > 0.1);
  PlaneStress<PerElement<NeoHookean>::law>::law<double> const graded{};
  detail::Sheet<NeoHookean<double>> const sheet{{3, 2}};
  CHECK(pliant::stress(graded.at(Vector<double, 2>{{{3}, {2}}}), h)(0, 0) ==
        pliant::stress(sheet, h)(0, 0));
  CHECK(parameters(graded).size() == 0);
  CHECK(parameters(sheets).size() == 5);
  CHECK(law_cast<float>(PlaneStress<NeoHookean>::law<double>::from({5.2, 0.3, 1})).solid.mu ==
        2.0f);
}

}  // namespace pliant::test::plane_stress_test
