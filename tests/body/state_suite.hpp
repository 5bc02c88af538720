#pragma once

#include "support/formulations.hpp"

namespace pliant::test::state_suite {

using Rubber = Formulation<Tri3, Gauss<1>, NeoHookean>;

TEST_CASE("displacements and velocities are read as they were set", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    using T = typename B::scalar;
    auto const mesh = distorted_mesh<Tri3>(5);
    auto body = body_of<Rubber>(backend, mesh);
    CHECK(largest(body.displacements()) == 0);
    CHECK(largest(body.velocities()) == 0);
    auto const u = Random(1).field<2>(mesh.nodes.size(), 0.02);
    auto const v = Random(2).field<2>(mesh.nodes.size(), 3.0);

    body.set_displacements(u);
    body.set_velocities(v);

    CHECK(difference(body.displacements(), rounded<T>(u)) == 0);
    CHECK(difference(body.velocities(), rounded<T>(v)) == 0);
  });
}

TEST_CASE("the energies are those of the state", "[body]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Tri3>(5);
    auto body = body_of<Rubber>(backend, mesh);
    body.set_gravity({1.5, -9});
    body.set_load(3, {2, 4});
    auto const u = Random(1).field<2>(mesh.nodes.size(), 0.02);
    auto const v = Random(2).field<2>(mesh.nodes.size(), 3.0);

    body.set_displacements(u);
    body.set_velocities(v);

    double kinetic = 0, potential = -(2 * u[3][0] + 4 * u[3][1]);
    for (std::size_t i = 0; i < u.size(); ++i) {
      double const m = body.parts().layout.mass_list()[i];
      kinetic += m * (v[i][0] * v[i][0] + v[i][1] * v[i][1]) / 2;
      potential -= m * (1.5 * u[i][0] - 9 * u[i][1]);
    }
    double const epsilon = 32 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    CHECK(kinetic_energy(body) == Approx(kinetic).epsilon(epsilon));
    CHECK(potential_energy(body) == Approx(potential).epsilon(epsilon));
    CHECK(total_energy(body) == Approx(strain_energy(body) + kinetic + potential).epsilon(epsilon));
  });
}

TEST_CASE("sides stay curved far from the origin", "[body]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    using Curved = Formulation<Tri6, Gauss<3>, NeoHookean>;
    auto mesh = mesh::rectangle<Tri6>({.size = {1, 1}, .cells = {2, 2}});
    for (auto& p : mesh.nodes) p[1] += 1e-3 * std::sin(7 * p[0]);
    auto const u = Random(1).field<2>(mesh.nodes.size(), 0.02);
    auto const energy_at = [&](double distance) {
      auto far = mesh;
      for (auto& p : far.nodes) p = {p[0] + distance, p[1] - distance};
      auto body = body_of<Curved>(backend, far);
      body.set_displacements(u);
      return strain_energy(body);
    };
    // Straight sides would change it by 1e-3.
    CHECK(energy_at(8192) == Approx(energy_at(0)).epsilon(3e-6));
  });
}

TEST_CASE("reading a state does not change where it goes", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Tri3>(5);
    auto watched = body_of<Rubber>(backend, mesh), left_alone = body_of<Rubber>(backend, mesh);
    CentralDifference step{{.step = 1e-3}}, other_step{{.step = 1e-3}};
    auto const v = Random(2).field<2>(mesh.nodes.size(), 0.1);
    watched.set_velocities(v);
    left_alone.set_velocities(v);

    for (int k = 0; k < 20; ++k) {
      step(watched);
      other_step(left_alone);
      (void)watched.velocities();
      (void)total_energy(watched);
      (void)watched.forces();
    }

    CHECK(difference(watched.displacements(), left_alone.displacements()) < 1e-15);
    CHECK(difference(watched.velocities(), left_alone.velocities()) < 1e-14);
    CHECK(watched.time() == Approx(0.02).epsilon(1e-14));
    CHECK(watched.steps() == 20);
  });
}

TEST_CASE("what changes after a step does not reach back into it", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Tri3>(4);
    auto const after_a_step = [&](auto const& change) {
      Body body{backend, mesh, soft, Group<Rubber>{}, Group<Formulation<Tri3, Gauss<1>, Hooke>>{}};
      body.set_gravity({0, -10});
      body.set_velocities(Random(2).field<2>(mesh.nodes.size(), 0.1));
      CentralDifference step{{.step = 1e-2}};
      step(body);
      change(body);
      return body.velocities();
    };

    auto const expected = after_a_step([](auto&) {});

    CHECK(difference(after_a_step([](auto& body) { body.set_gravity({0, 20}); }), expected) == 0);
    CHECK(difference(after_a_step([](auto& body) { body.set_damping(5); }), expected) == 0);
    CHECK(difference(after_a_step([](auto& body) { body.set_load(3, {1, 1}); }), expected) == 0);
    CHECK(difference(after_a_step([](auto& body) {
                       body.template assign<Formulation<Tri3, Gauss<1>, Hooke>>({0, 1, 2, 3, 4, 5});
                     }),
                     expected) == 0);
  });
}

}  // namespace pliant::test::state_suite
