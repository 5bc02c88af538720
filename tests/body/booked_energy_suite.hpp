#pragma once

#include "support/formulations.hpp"

namespace pliant::test::booked_energy_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

/// The energy that leapfrog keeps, J, less what is booked.
template <class TheBody>
double kept_energy(TheBody& body) {
  return leapfrog_energy(body.parts()).kept() - booked_energy(body.parts());
}

TEST_CASE("changes between steps are booked to rounding", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(5);
    Body body{backend, mesh, soft, Group<Rubber>{}, Group<Linear>{}};
    auto const left = body.clamp(mesh.boundary("left"));
    body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 0.1));
    body.set_gravity({0.01, -0.02});
    CentralDifference step{{.safety = 0.5}};
    step(body, 20);
    double const size = strain_energy(body) + kinetic_energy(body);
    auto const booked = [&](auto const& change) {
      step(body, 3);
      double const before = kept_energy(body), work = booked_energy(body.parts());
      change();
      CHECK(std::abs(kept_energy(body) - before) < 1e-13 * size);
      CHECK(std::abs(booked_energy(body.parts()) - work) > 1e-9 * size);
    };

    booked([&] { body.set_gravity({0.05, 0.07}); });
    booked([&] { body.set_loads(Random(2).field<2>(mesh.nodes.size(), 0.01)); });
    booked([&] { body.template assign<Linear>({1, 4, 7, 8}); });
    booked([&] { body.hold(mesh.boundary("right"), 1); });
    booked([&] { body.release(left); });
    booked([&] { body.set_velocities(Random(3).field<2>(mesh.nodes.size(), 0.1)); });
    booked([&] { refine(body, {{2, 3, 9}}); });
    booked(
        [&] { body.set_loads(Random(2).field<2>(static_cast<std::size_t>(body.nodes()), 0.01)); });
    booked([&] { refine(body, {{2, 5}}); });
  });
}

TEST_CASE("refining keeps the work of loads booked", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(5);
    auto body = body_of<Rubber>(backend, mesh);
    body.set_displacements(Random(1).field<2>(mesh.nodes.size(), 0.01));
    body.set_load(2, {1, 2});
    auto const work = download<double>(body.state().work);
    REQUIRE(work[static_cast<std::size_t>(Work::changed_loads)] != 0);
    refine(body, {{2, 3, 9}});
    CHECK(download<double>(body.state().work) == work);
  });
}

TEST_CASE("reading does not change what an integrator compares energies with", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(5);
    auto watched = body_of<Rubber>(backend, mesh), left_alone = body_of<Rubber>(backend, mesh);
    for (auto* body : {&watched, &left_alone}) {
      body->set_damping(0.5);
      body->set_gravity({0.03, -0.01});
      body->set_loads(Random(3).field<2>(mesh.nodes.size(), 0.01));
      body->set_velocities(Random(2).field<2>(mesh.nodes.size(), 0.1));
    }
    CentralDifference step{{.check_interval = 7, .refresh_interval = 5}};
    for (int k = 0; k < 400; ++k) {  // some hundred: sums hide most last bits
      step(watched, 3);
      step(left_alone, 3);
      (void)total_energy(watched);
      (void)watched.forces();
    }
    (void)left_alone.velocities();
    CHECK(watched.time() == left_alone.time());
    CHECK(watched.displacements() == left_alone.displacements());
    CHECK(watched.velocities() == left_alone.velocities());
    CHECK(watched.state().integrator.first_energy == left_alone.state().integrator.first_energy);
    CHECK(watched.state().integrator.last_energy == left_alone.state().integrator.last_energy);
    CHECK(download<double>(watched.state().work) == download<double>(left_alone.state().work));
  });
}

}  // namespace pliant::test::booked_energy_suite
