#pragma once

#include <algorithm>

#include "support/formulations.hpp"

namespace pliant::test::press_suite {

using Quads = Formulation<Quad4, Gauss<2>, Hooke>;
using Bricks = Formulation<Hex8, Gauss<2>, Hooke>;

/// The facets in another order, each seen from the other side.
template <class F>
std::vector<F> turned(std::vector<F> facets) {
  std::reverse(facets.begin(), facets.end());
  for (F& facet : facets) std::reverse(facet.begin(), facet.end());
  return facets;
}
template <class TheBody>
double pull(TheBody& body) {
  double sum = 0;
  for (auto const& f : body.forces())
    for (double x : f) sum += std::abs(x);
  return sum;
}

TEST_CASE("pressing facets again in another order or orientation replaces", "[constraint]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const check = [](auto body) {
      auto const facets = body.mesh().boundary("top");
      auto const first = body.press(facets, 100);
      double const single = pull(body);

      CHECK(body.press(turned(facets), 200) == first);

      CHECK(single > 0);
      CHECK(pull(body) == Approx(2 * single));
    };
    check(body_of<Quads>(backend, mesh::rectangle({.size = {1, 1}, .cells = {4, 4}})));
    check(body_of<Bricks>(backend, mesh::box<Hex8>({.size = {1, 1, 1}, .cells = {2, 2, 2}})));
  });
}

TEST_CASE("pressing a refined boundary replaces, whichever way its facets ran", "[constraint]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto mesh = mesh::rectangle({.size = {1, 1}, .cells = {4, 4}});
    mesh.boundaries.at("top") = turned(mesh.boundary("top"));
    auto body = body_of<Quads>(backend, mesh);
    body.press(body.mesh().boundary("top"), 100);
    double const before = pull(body);
    refine(body, {{12, 13, 15}});

    body.press(body.mesh().boundary("top"), 100);

    CHECK(pull(body) == Approx(before));
    CHECK(body.state().prescribed->pressures.size() == 1);
  });
}

}  // namespace pliant::test::press_suite
