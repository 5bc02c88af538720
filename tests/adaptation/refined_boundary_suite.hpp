#pragma once

#include "support/formulations.hpp"

namespace pliant::test::refined_boundary_suite {

TEST_CASE("conditions, pressures and named boundaries go over to both halves of a facet",
          "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
    auto body = body_of<Rubber>(backend, mesh);
    body.clamp(mesh.boundary("left"));
    body.press(mesh.boundary("bottom"), 1);

    refine(body, {{0}});

    auto const& prescribed = *body.state().prescribed;
    CHECK(prescribed.conditions[0].nodes.size() == 4);
    CHECK(prescribed.conditions[0].facets.size() == 3);
    CHECK(prescribed.pressures[0].facets.size() == 9);
    CHECK(body.mesh().boundary("left").size() == 3);
    CHECK(body.mesh().boundary("bottom").size() == 9);
    for (Index node : prescribed.conditions[0].nodes)
      CHECK(body.mesh().nodes[static_cast<std::size_t>(node)][0] == 0);
  });
}

TEST_CASE("a family keeps the momentum of distorted parents", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
    auto const mesh = distorted_mesh<Quad4>(4);
    auto body = body_of<Rubber>(backend, mesh);
    body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 1));
    auto const momentum = [&] {
      auto p = body.velocities();
      for (std::size_t i = 0; i < p.size(); ++i)
        for (double& x : p[i]) x *= body.parts().layout.mass_list()[i];
      return total(p);
    };
    auto const before = momentum();

    refine(body, {{3, 5}});

    for (std::size_t k = 0; k < 2; ++k)
      CHECK(momentum()[k] == Approx(before[k]).margin(1e-13 * soft.density));
  });
}

}  // namespace pliant::test::refined_boundary_suite
