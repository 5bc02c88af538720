#pragma once

#include "support/formulations.hpp"

namespace pliant::test {

TEST_CASE("conditions, pressures and named boundaries go over to both halves of a facet",
          "[adaptation]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
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

}  // namespace pliant::test
