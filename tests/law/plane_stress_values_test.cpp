#include <pliant/law/decorators/plane_stress.hpp>

#include "support/laws.hpp"

namespace pliant::test::plane_stress_values_test {

TEST_CASE("a sheet in uniaxial stress is a bar", "[law]") {
  // REFERENCES, section 6: l1, l2 and P11 of the solid with free lateral faces.
  auto const check = [](auto const& solid, double l1, double l2, double p11) {
    detail::Sheet<std::remove_cvref_t<decltype(solid)>> const sheet{solid};
    auto const h = diagonal<2>({l1 - 1, l2 - 1, 0});
    auto const p = pliant::stress(sheet, h);
    CHECK(p(0, 0) == Approx(p11).epsilon(0).margin(2e-11));
    CHECK(p(1, 1) == Approx(0).margin(2e-11));
    CHECK(1 + sheet.thickening(h) == Approx(l2).epsilon(0).margin(2e-11));
  };
  check(Hooke<double>{3, 2}, 1.2, .94, 1.04);
  check(SaintVenantKirchhoff<double>{3, 2}, 1.2, .931665175908, 1.3728);
  check(SaintVenantKirchhoff<double>{3, 2}, .7, 1.073778375644, -.9282);
  check(NeoHookean<double>{3, 2}, 1.2, .945632624291, .909631566460);
  check(NeoHookean<double>{3, 2}, .7, 1.107934732848, -2.107198206434);
  check(IsochoricNeoHookean<double>{2, 5}, 1.2, .942559609546, .880898256862);
  check(IsochoricNeoHookean<double>{2, 5}, .7, 1.117013463364, -2.369355752576);
  check(MooneyRivlin<double>{.75, .25, 5}, 1.2, .941647717155, .851771181455);
}

TEST_CASE("a sheet finds its thickness at large stretches, nearly incompressible too", "[law]") {
  auto const check = [](auto const& solid) {
    detail::Sheet<std::remove_cvref_t<decltype(solid)>> const sheet{solid};
    for (double l1 : {0.5, 1.0, 2.0})
      for (double l2 : {0.5, 1.0, 2.0}) {
        INFO("stretches " << l1 << ", " << l2);
        auto const h = diagonal<2>({l1 - 1, l2 - 1, 0});
        auto in_3d = in_space(h);
        in_3d(2, 2) = sheet.thickening(h);
        auto const slope = stress_tangent_product(solid, in_3d, diagonal<3>({0, 0, 1}))(2, 2);
        CHECK(std::abs(pliant::stress(solid, in_3d)(2, 2)) < 1e-12 * slope);
      }
  };
  for (double poisson : {0.0, 0.3, 0.4995}) {
    Elastic const material{3, poisson, 1};
    check(NeoHookean<double>::from(material));
    check(StableNeoHookean<double>::from(material));
    check(MooneyRivlin<double>::from(material));
    check(Ogden<double>::from(material));
  }
}

TEST_CASE("an incompressible sheet thins as it is stretched", "[law]") {
  // Mooney-Rivlin: P11 = 2 (c1 + c2 l2²) (l1 − 1/(l1³ l2²)).
  double const bulk = 1e7, l1 = 2, l2 = 0.8;
  detail::Sheet<MooneyRivlin<double>> const sheet{{0.75, 0.25, bulk}};
  auto const p = pliant::stress(sheet, diagonal<2>({l1 - 1, l2 - 1, 0}));
  CHECK(1 + sheet.thickening(diagonal<2>({l1 - 1, l2 - 1, 0})) ==
        Approx(1 / (l1 * l2)).epsilon(2e-6));
  CHECK(p(0, 0) ==
        Approx(2 * (0.75 + 0.25 * l2 * l2) * (l1 - 1 / (std::pow(l1, 3) * l2 * l2))).epsilon(2e-6));
}

TEST_CASE("a sheet keeps its digits in single precision", "[law]") {
  auto const check = []<template <class> class L>(L<double> const&) {
    for (double strain : {1e-5, 1e-3, 0.1}) {
      Random random(20);
      for (int state = 0; state < 30; ++state) {
        auto const drawn = random_state<2>(random, strain);
        Tensor<float, 2> h;
        Tensor<double, 2> same;
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) same(i, j) = h(i, j) = static_cast<float>(drawn(i, j));
        auto const p = pliant::stress(detail::Sheet<L<float>>{law_of_section_6<L, float>}, h);
        auto const exact = pliant::stress(detail::Sheet<L<double>>{law_of_section_6<L>}, same);
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j)
            CHECK(std::abs(double{p(i, j)} - exact(i, j)) < 3e-6 * largest<2>(exact));
      }
    }
  };
  check(NeoHookean<double>{});
  check(MooneyRivlin<double>{});
  check(Corotated<double>{});
}

}  // namespace pliant::test::plane_stress_values_test
