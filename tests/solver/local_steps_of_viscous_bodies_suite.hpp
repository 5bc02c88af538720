#pragma once

#include <sstream>

#include <pliant/adaptation/adapt.hpp>
#include <pliant/solver/local_steps.hpp>

#include "support/formulations.hpp"
#include "support/repeatable.hpp"
#include "support/small_patches.hpp"

// Points of elements with a step of their own keep what they keep from step to step; looks between macro steps.
namespace pliant::test::local_steps_of_viscous_bodies_suite {

using Viscous = Formulation<Quad4, Gauss<2>, Prony<NeoHookean, 2>::template law>;
using Elastics = Formulation<Quad4, Gauss<2>, NeoHookean>;
inline constexpr Elastic gel{1e5, 0.3, 1e3};
using Patches = SmallPatches<double, 1>;

/// One branch relaxes within some steps, one in as long as a strip swings.
inline auto viscous_law() {
  return Prony<NeoHookean, 2>::law<double>{NeoHookean<double>::from(gel), {0.6, 0.8}, {2e-3, 5e-2}};
}

/// A strip whose right end is split twice, thrown and pulled.
template <class B>
auto viscous_strip(B const& backend) {
  Body body{backend, shaken(mesh::rectangle({.size = {1, 0.25}, .cells = {12, 3}}), 0.01), gel,
            Group<Viscous>{viscous_law()}};
  refine(body, {{35}});
  refine(body, {{static_cast<Index>(body.mesh().template elements<Quad4>().size() - 1)}});
  body.clamp(body.mesh().boundary("left"));
  body.set_gravity({0, -3});
  auto v = body.mesh().nodes;
  for (auto& x : v) x = {0.3 * x[0], 0};
  body.set_velocities(v);
  return body;
}

TEST_CASE("viscous bodies with one level of local steps take central differences", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = shaken(mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}}), 0.02);
    auto const make = [&] {
      Body body{backend, mesh, gel, Group<Viscous>{viscous_law()}};
      body.clamp(mesh.boundary("left"));
      body.set_gravity({0, -3});
      return body;
    };
    auto local = make(), global = make();
    double const dt = 0.4 * stable_step(global);
    LocalSteps step{{.macro_step = dt}};
    CentralDifference other{{.step = dt}};

    for (int k = 0; k < 40; ++k) step(local);
    step(local, 60);
    other(global, 100);

    REQUIRE(local.parts().schedule->finest == 0);
    CHECK(difference(local.displacements(), global.displacements()) < 1e-13);
    CHECK(difference(local.velocities(), global.velocities()) < 1e-11);

    // Each takes the other's body over.
    step(global, 7);
    other(local, 7);
    CHECK(difference(local.displacements(), global.displacements()) < 1e-13);
  });
}

TEST_CASE("local steps of viscous bodies are of second order", "[solver]") {
  Patches const backend;
  auto const run = [&](double safety, int steps, double& time) {
    auto body = viscous_strip(backend);
    LocalSteps step{{.safety = safety,
                     .check_interval = 1 << 28,
                     .refresh_interval = 1 << 28,
                     .watch_interval = 1 << 28}};
    step(body, steps / 2);
    step(body, steps / 2);
    CHECK(body.parts().schedule->finest >= 2);
    CHECK(body.parts().schedule->evaluations < 0.85);
    time = body.time();
    return body.displacements();
  };
  double time = 0, same = 0;
  auto const coarse = run(0.4, 16, time), middle = run(0.2, 32, same), fine = run(0.1, 64, same);
  auto exact = viscous_strip(backend);
  CentralDifference step{{.step = time / 8000, .check_interval = 1 << 28}};
  step(exact, 8000);
  auto const error = [&](auto const& u) { return difference(u, exact.displacements()); };

  CHECK(same == Approx(time).epsilon(1e-12));
  CHECK(error(coarse) < 1e-2 * largest(exact.displacements()));
  CHECK(error(coarse) / error(middle) == Approx(4).epsilon(0.2));
  CHECK(error(middle) / error(fine) == Approx(4).epsilon(0.2));
}

TEST_CASE("a viscous run with local steps goes on from a file with the same bits", "[solver]") {
  on_each_backend<std::tuple<Patches, MainBackend>>([]<class B>(B const& backend) {
    auto straight = viscous_strip(backend);
    LocalSteps step{{.check_interval = 7, .watch_interval = 3}};
    step(straight, 20);
    std::stringstream file;
    straight.save(file);
    auto other = viscous_strip(backend);
    other.load(file);
    LocalSteps again{{.check_interval = 7, .watch_interval = 3}};

    step(straight, 20);
    again(other, 20);

    CHECK(difference(straight.displacements(), other.displacements()) <= between_runs(1e-12));
    CHECK(difference(straight.velocities(), other.velocities()) <= between_runs(1e-11));
  });
}

TEST_CASE("an adaptation looks between macro steps as one that is called behind each", "[solver]") {
  on_each_backend<std::tuple<Patches, MainBackend>>([]<class B>(B const& backend) {
    using Cheap = Formulation<Quad4, Gauss<2>, Hooke>;
    auto const make = [&] {
      auto const mesh = shaken(mesh::rectangle({.size = {1, 0.25}, .cells = {12, 3}}), 0.01);
      Body body{backend, mesh, gel, Group<Cheap>{}, Group<Elastics>{}};
      body.clamp(mesh.boundary("left"));
      body.set_gravity({0, -3});
      return body;
    };
    auto const rules = [] {
      return Adaptation{when<Cheap>(StrainNorm{}).above(2e-2).template become<Elastics>(),
                        when<Elastics>(StrainNorm{}).above(4e-2).refine({.max_level = 1})}
          .every(3);
    };
    auto one = make(), other = make();
    auto adapt = rules(), behind = rules();
    LocalSteps step, again;

    Advanced const done = step(one, 50, adapt);
    for (int k = 0; k < 50; ++k) {
      again(other);
      behind(other);
    }

    CHECK(done.steps == 50);
    CHECK(one.steps() == 50);
    CHECK(one.mesh().nodes.size() > 52);
    REQUIRE(one.mesh().nodes.size() == other.mesh().nodes.size());
    CHECK(difference(one.displacements(), other.displacements()) < 1e-10);
    CHECK(step(one, 0, adapt).steps == 0);
    CHECK_THROWS_WITH(step(one, -1, adapt), says("0 or more"));
  });
}

}  // namespace pliant::test::local_steps_of_viscous_bodies_suite
