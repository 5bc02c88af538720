#pragma once

#include "support/formulations.hpp"

// What a user may do to a body between the calls of an integrator.
namespace pliant::test {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Stiff = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
inline constexpr Elastic gel{1e5, 0.3, 1e3};
inline constexpr Index tip = 8;

inline Mesh<Quad4> beam() { return mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}}); }
template <class B>
auto held_beam(B const& backend) {
  auto body = body_of<Linear>(backend, beam(), gel);
  body.clamp(body.mesh().boundary("left"));
  return body;
}

TEST_CASE("a load on a body at rest is no blow-up", "[solver]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    for (bool all : {false, true}) {
      auto body = held_beam(backend);
      CentralDifference step;
      step(body, 256);
      if (all) {
        FieldOf<2> loads(static_cast<std::size_t>(body.nodes()), {0, 0});
        loads[tip] = {0, -1};
        body.set_loads(loads);
      } else {
        body.set_load(tip, {0, -1});
      }

      Advanced const done = step(body, 256);

      CHECK(step.retries() == 0);
      CHECK(done.steps == 256);
      CHECK(body.displacements()[tip][1] < 0);
    }
  });
}

TEST_CASE("loads that change again and again are no blow-up, and hide none", "[solver]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const run = [&](double fraction) {
      auto body = held_beam(backend);
      CentralDifference step{{.step = fraction * stable_step(body), .check_interval = 5}};
      Random random(3);
      for (int k = 0; k < 1000; ++k) {
        body.set_load(tip, random.field<2>(1, k % 7 == 0 ? 100 : 1)[0]);
        step(body);
      }
      CHECK(largest(body.displacements()) < 1);
      return step.retries();
    };
    CHECK(run(0.9) == 0);
    CHECK(run(1.5) > 0);
  });
}

}  // namespace pliant::test
