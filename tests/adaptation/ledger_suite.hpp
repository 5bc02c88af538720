#pragma once

#include "support/formulations.hpp"

// What switching does to the energy of a swing is in the ledger.
namespace pliant::test::ledger_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Turning = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;

struct Swing {
  double unbooked;  // over the largest strain energy
  double booked;    // the same, of what switching added
  int retries;
};

/// README's adaptive cantilever on a coarser mesh.
template <class B>
Swing swing(B const& backend, double threshold, double safety, int steps) {
  auto const mesh = mesh::rectangle({.size = {1, 0.1}, .cells = {40, 4}});
  Body body{backend, mesh, Elastic{2e6, 0.3, 1e3}, Group<Linear>{}, Group<Turning>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -9.81});
  auto const deformed = largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{});
  auto adapt = Adaptation{when<Linear>(deformed).above(threshold).template become<Turning>(),
                          when<Turning>(deformed).below(threshold / 2).template become<Linear>()}
                   .every(2);
  CentralDifference step{{.safety = safety}};
  step(body);
  auto const kept = [&] {
    return leapfrog_energy(body.parts()).kept() - booked_energy(body.parts());
  };
  double const first = kept();
  double unbooked = 0, peak = 0;
  while (body.steps() < steps) {
    step(body);
    adapt(body);
    if (body.steps() % 100 != 0) continue;
    unbooked = std::max(unbooked, std::abs(kept() - first));
    peak = std::max(peak, strain_energy(body));
  }
  return {unbooked / peak, std::abs(adaptation_energy(body)) / peak, step.retries()};
}

TEST_CASE("what switching adds to the energy of a swing is booked", "[adaptation]") {
  MainBackend const backend{};
  auto const early = swing(backend, 0.02, 0.9, 4000), late = swing(backend, 0.1, 0.3, 6000);
  CAPTURE(early.booked, early.unbooked, late.booked, late.unbooked);

  CHECK(early.booked > 1e-4);  // there is something to book
  CHECK(late.booked > 0.01);
  CHECK(early.unbooked < 1e-5);
  CHECK(late.unbooked < 5e-4);
  CHECK(early.retries + late.retries == 0);
}

TEST_CASE("what leapfrog keeps changes by what is booked of a switch", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
    auto const make = [&] {
      Body body{backend, mesh, Elastic{1e5, 0.3, 1e3}, Group<Linear>{}, Group<Turning>{}};
      body.clamp(mesh.boundary("left"));
      body.set_gravity({0, -20});
      CentralDifference step{{.safety = 0.9}};
      step(body, 30);
      return body;
    };
    Adaptation adapt{when<Linear>(EdgeLengthRatio{}).above(-1).template become<Turning>()};
    for (bool pending : {true, false}) {
      INFO((pending ? "a half-kick is pending" : "velocities of the present time"));
      auto before = make(), body = make();
      if (!pending) body.velocities();
      adapt.now(body);

      double const scale = strain_energy(before), start = leapfrog_energy(before.parts()).kept();
      double of_elements = 0, of_all_together = 0;
      for (auto const& entry : ledger(body))
        (entry.elements > 0 ? of_elements : of_all_together) += entry.kinetic_energy;
      CHECK(std::abs(of_elements + of_all_together) > 1e-4 * scale);
      CHECK((pending ? of_all_together : of_elements) == 0);
      CHECK(std::abs(leapfrog_energy(body.parts()).kept() - start - adaptation_energy(body)) <
            1e-12 * scale);
    }
  });
}

}  // namespace pliant::test::ledger_suite
