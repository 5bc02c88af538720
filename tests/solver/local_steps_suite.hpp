#pragma once

#include <pliant/solver/local_steps.hpp>

#include "support/formulations.hpp"

// Each element has its own time step.
namespace pliant::test {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
inline constexpr Elastic gel{1e5, 0.3, 1e3};
TEST_CASE("with one level local steps are central differences", "[solver]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const mesh = shaken(mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}}), 0.02);
    auto const make = [&] {
      auto body = body_of<Rubber>(backend, mesh, gel);
      body.clamp(mesh.boundary("left"));
      body.set_gravity({0, -3});
      body.set_load(20, {1, 2});
      body.set_damping(0.7);
      body.drive(mesh.boundary("right"),
                 [](double t) -> Point<2> {
                   return {0.1 * t * t, 0};
                 },
                 {.directions = 1});
      body.press(mesh.boundary("top"), 50);
      return body;
    };
    auto local = make(), global = make();
    double const dt = 0.4 * stable_step(global);
    LocalSteps step{{.macro_step = dt}};
    CentralDifference other{{.step = dt}};

    step(local, 40);
    step(local, 60);
    other(global, 100);

    REQUIRE(local.parts().schedule->finest == 0);
    CHECK(difference(local.displacements(), global.displacements()) < 1e-13);
    CHECK(difference(local.velocities(), global.velocities()) < 1e-12);
    CHECK(local.time() == Approx(global.time()).epsilon(1e-14));
    auto const work = external_work(local), same = external_work(global);
    CHECK(work.damping == Approx(same.damping).epsilon(1e-11));
    CHECK(work.motions == Approx(same.motions).epsilon(1e-11));
    CHECK(work.pressures == Approx(same.pressures).epsilon(1e-11));
  });
}

}  // namespace pliant::test
