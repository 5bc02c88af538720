#include <pliant/formulation/affine.hpp>

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

/// The cell moved by X = X_0 + A ξ, far from the origin.
template <class E>
Nodal<E, double> sheared(Tensor<double, E::dim> const& a) {
  Nodal<E, double> rest;
  for (int n = 0; n < E::nodes; ++n)
    for (int i = 0; i < E::dim; ++i) {
      rest(n, i) = 40;
      for (int k = 0; k < E::dim; ++k) rest(n, i) += a(i, k) * E::place(n)[k];
    }
  return rest;
}

TEMPLATE_TEST_CASE("affine elements are told from others, and have the shares of all",
                   "[formulation]", ALL_ELEMENTS) {
  using E = TestType;
  Random random;
  Tensor<double, E::dim> a;
  for (int i = 0; i < E::dim; ++i)
    for (int k = 0; k < E::dim; ++k) a(i, k) = (i == k) + 0.4 * random();
  auto rest = sheared<E>(a);
  auto const gradient = affine_gradient<E>(rest);
  REQUIRE(gradient);
  for (int i = 0; i < E::dim; ++i)
    for (int k = 0; k < E::dim; ++k) CHECK((*gradient)(i, k) == Approx(a(i, k)).margin(1e-12));
  auto const compare = [&] {
    auto const share = host_nodal_volumes<E>(rest), expected = nodal_volumes<E>(rest);
    for (int n = 0; n < E::nodes; ++n) CHECK(share[n] == Approx(expected[n]).epsilon(1e-12));
  };
  compare();
  if (LinearSimplex<E>) return;
  for (int n = 0; n < E::nodes; ++n) {
    if (E::nodes == 5 && n == 4) continue;  // a pyramid's apex may be anywhere
    auto const straight = rest;
    rest(n, 0) += 1e-9;  // m: more than rounding
    CHECK(!affine_gradient<E>(rest));
    rest(n, 0) += 0.05;
    CHECK(!affine_gradient<E>(rest));
    compare();
    rest = straight;
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
