#include <pliant/formulation/mass.hpp>

#include "support/catch.hpp"
#include "support/elements.hpp"
#include "support/random.hpp"

namespace pliant::test::mass_test {

/// An element whose nodes are moved: curved where it can be.
template <class E>
Nodal<E, double> crooked(double distance) {
  Random random;
  Nodal<E, double> rest;
  for (int a = 0; a < E::nodes; ++a)
    for (int k = 0; k < E::dim; ++k) rest(a, k) = E::place(a)[k] + distance * random();
  return rest;
}

TEMPLATE_TEST_CASE("every node has a positive share of the volume, and no volume is lost",
                   "[formulation]", ALL_ELEMENTS) {
  for (double distance : {0.0, 0.05}) {
    auto const rest = crooked<TestType>(distance);
    auto const share = nodal_volumes<TestType>(rest);
    double sum = 0;
    for (int a = 0; a < TestType::nodes; ++a) {
      CHECK(share[a] > 0);
      sum += share[a];
    }
    // A rule of far more points than the mass's own.
    double const exact =
        volume<TestType, Gauss<SimplexCell<typename TestType::cell> ? 6 : 5>>(rest);
    CHECK(sum == Approx(exact).epsilon(1e-13));
  }
}

TEST_CASE("shares on regular cells are those of the literature", "[formulation]") {
  auto const share = []<class E>(E, int a) {
    return nodal_volumes<E>(crooked<E>(0))[a] / E::cell::volume;
  };
  SECTION("row sums") {
    CHECK(share(Tet4{}, 2) == Approx(1.0 / 4));
    CHECK(share(Hex8{}, 5) == Approx(1.0 / 8));
    CHECK(share(Wedge6{}, 1) == Approx(1.0 / 6));
    CHECK(share(Pyramid5{}, 4) == Approx(1.0 / 4));
    CHECK(share(Pyramid5{}, 0) == Approx(3.0 / 16));
  }
  SECTION("diagonal scaling (Hinton, Rock, Zienkiewicz 1976): 3/57 and 16/57 of a triangle") {
    CHECK(share(Tri6{}, 0) == Approx(3.0 / 57));
    CHECK(share(Tri6{}, 4) == Approx(16.0 / 57));
    CHECK(share(Tet10{}, 0) == Approx(1.0 / 36));
    CHECK(share(Tet10{}, 5) == Approx(4.0 / 27));
    CHECK(share(Quad8{}, 2) == Approx(3.0 / 76));
    CHECK(share(Quad8{}, 6) == Approx(16.0 / 76));
  }
  SECTION("nodal: Simpson's weights") {
    CHECK(share(Quad9{}, 0) == Approx(1.0 / 36));
    CHECK(share(Quad9{}, 4) == Approx(4.0 / 36));
    CHECK(share(Quad9{}, 8) == Approx(16.0 / 36));
    CHECK(share(Hex27{}, 0) == Approx(1.0 / 216));
    CHECK(share(Hex27{}, 8) == Approx(4.0 / 216));
    CHECK(share(Hex27{}, 20) == Approx(16.0 / 216));
    CHECK(share(Hex27{}, 26) == Approx(64.0 / 216));
  }
}

}  // namespace pliant::test::mass_test
