#pragma once

#include "support/formulations.hpp"

namespace pliant::test::contradictory_conditions_suite {

TEST_CASE("conditions that contradict each other are refused and change nothing", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {4, 1}});
    auto body = body_of<Rubber>(backend, mesh);
    auto const rise = [](double t) -> Point<2> { return {0, t}; };
    body.hold(mesh.boundary("left"), 1);
    Handle const driven = body.drive(mesh.boundary("right"), rise, {.directions = 2});

    CHECK_THROWS_WITH(body.drive(mesh.boundary("left"), rise), says("holds"));
    CHECK_THROWS_WITH(body.drive(mesh.boundary("right"), rise, {.directions = 2}), says("drives"));
    CHECK_THROWS_WITH(body.hold(mesh.boundary("right"), 3), says("drives"));
    CHECK(body.state().prescribed->conditions.size() == 2);

    CHECK_NOTHROW(body.hold(mesh.boundary("right"), 1));
    CHECK_NOTHROW(body.drive(mesh.boundary("left"), rise, {.directions = 2}));
    body.release(driven);
    CHECK_NOTHROW(body.hold(mesh.boundary("right"), 2));
  });
}

}  // namespace pliant::test::contradictory_conditions_suite
