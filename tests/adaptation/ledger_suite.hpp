#pragma once

#include "support/formulations.hpp"

// What switching does to the energy of a swing is in the ledger.
namespace pliant::test {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Turning = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;

/// The modified energy of leapfrog to second order, W + T + Δt²/12 v·K·v − Δt²/24 a·M·a (Hairer, Lubich and
/// Wanner, Geometric Numerical Integration, IX.3), with v₋·K·v₊ for v·K·v, so that for linear laws it is
/// constant to rounding: what leapfrog keeps plus Δt²/12 (a·M·a + v₋·K·v₊), twice the same of its derivative.
template <class TheBody>
double modified_energy(TheBody& body) {
  auto& parts = body.parts();
  double const step = parts.state.integrator.step;
  double const kept = leapfrog_energy(parts).kept();
  auto const u = body.displacements(), v = body.velocities(), f = body.forces();
  auto const held =
      held_directions(parts, std::span(std::as_const(parts.state.prescribed->conditions)));
  std::size_t const nodes = u.size();
  std::vector<double> place, after, before;
  double sum = 0;
  for (std::size_t i = 0; i < nodes; ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      double const m = parts.layout.mass_list[i];
      bool const holds =
          held[static_cast<std::size_t>(parts.layout.internal_of(static_cast<Index>(i)))] >> k & 1;
      double const a = holds ? 0 : f[i][k] / m + parts.state.gravity[k];
      sum += m * a * a;
      place.push_back(u[i][k]);
      after.push_back(v[i][k] + step / 2 * a);
      before.push_back(v[i][k] - step / 2 * a);
    }
  auto const here = upload(parts.backend, place), along = upload(parts.backend, after);
  auto pull = zeros<double>(parts.backend, 2 * nodes);
  body.add_tangent_product(here.data(), along.data(), pull.data(), -1);
  auto const product = download<double>(pull);
  for (std::size_t i = 0; i < product.size(); ++i) sum += before[i] * product[i];
  return kept + step * step / 12 * sum;
}

struct Swing {
  double unbooked;  // over the largest strain energy
  double booked;    // the same, of what switching added
  int retries;
};

/// README's adaptive cantilever on a coarser mesh.
template <class B>
Swing swing(B const& backend, double safety, int steps, int every) {
  auto const mesh = mesh::rectangle({.size = {1, 0.1}, .cells = {40, 4}});
  Body body{backend, mesh, Elastic{2e6, 0.3, 1e3}, Group<Linear>{}, Group<Turning>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -9.81});
  auto const deformed = largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{});
  auto adapt = Adaptation{when<Linear>(deformed).above(0.10).template become<Turning>(),
                          when<Turning>(deformed).below(0.05).template become<Linear>()}
                   .every(every);
  CentralDifference step{{.safety = safety}};
  step(body);
  double const first = modified_energy(body) - booked_energy(body.parts());
  double unbooked = 0, peak = 0;
  while (body.steps() < steps) {
    step(body);
    adapt(body);
    if (body.steps() % 100 != 0) continue;
    unbooked =
        std::max(unbooked, std::abs(modified_energy(body) - booked_energy(body.parts()) - first));
    peak = std::max(peak, strain_energy(body));
  }
  return {unbooked / peak, std::abs(adaptation_energy(body)) / peak, step.retries()};
}

TEST_CASE("what switching adds to the energy of a swing is booked", "[adaptation]") {
  MainBackend const backend{};
  auto const coarse = swing(backend, 0.9, 4000, 2);
  auto const fine = swing(backend, 0.3, 6000, 2);

  CHECK(coarse.booked > 0.02);  // there is something to book
  CHECK(fine.booked > 0.01);
  CAPTURE(coarse.booked, fine.booked, fine.unbooked);
  CHECK(coarse.unbooked < 5e-3);
  CHECK(fine.unbooked < 2e-4);
  CHECK(coarse.retries == 0);
}

TEST_CASE("squares of forces that change together are in the ledger", "[adaptation]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    // All elements change at once, after a step: the modified energy changes by what is booked.
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
    auto const make = [&] {
      Body body{backend, mesh, Elastic{1e5, 0.3, 1e3}, Group<Linear>{}, Group<Turning>{}};
      body.clamp(mesh.boundary("left"));
      body.set_gravity({0, -20});
      CentralDifference step{{.safety = 0.1}};
      step(body, 300);
      return body;
    };
    Adaptation adapt{when<Linear>(EdgeLengthRatio{}).above(-1).template become<Turning>()};
    auto const of_all_together = [](auto const& body) {
      double sum = 0;
      for (auto const& entry : ledger(body))
        if (entry.elements == 0) sum += entry.kinetic_energy;
      return sum;
    };
    auto before = make(), synchronized = make(), pending = make();
    double const start = modified_energy(before);
    synchronized.velocities();  // gives them the half-kick that the last step left pending

    adapt.now(synchronized);
    adapt.now(pending);

    double const added = of_all_together(pending);
    CHECK(added > 0);
    CHECK(of_all_together(synchronized) == Approx(-added / 2));
    for (auto* body : {&synchronized, &pending}) {
      double const change = modified_energy(*body) - start;
      CHECK(std::abs(change - adaptation_energy(*body)) < 0.05 * added);
    }
  });
}

}  // namespace pliant::test
