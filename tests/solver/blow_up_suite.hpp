#pragma once

#include "support/formulations.hpp"

namespace pliant::test::blow_up_suite {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

inline Mesh<Quad4> strip() { return mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}}); }

template <class TheBody>
bool finite(TheBody& body) {
  return std::isfinite(largest(body.displacements())) && std::isfinite(largest(body.velocities()));
}

TEST_CASE("a step that is somewhat too large is halved and done again", "[solver]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto body = body_of<Rubber>(backend, strip());
    body.clamp(body.mesh().boundary("left"));
    body.set_gravity({0, -0.05});
    double const stable = stable_step(body);
    CentralDifference step{{.step = 4 * stable, .check_interval = 32}};

    step(body, 400);

    CHECK(step.retries() >= 1);
    CHECK(step.retries() <= 3);
    CHECK(step.step() < 2 * stable / 0.4);
    CHECK(finite(body));
    CHECK(total_energy(body) < 1e-2 * strain_energy(body) + 1e-4);
    CHECK(body.steps() == 400);
  });
}

TEST_CASE("time and state go back together", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = body_of<Rubber>(backend, strip());
    body.set_gravity({0, -1});
    body.set_velocities(Random(1).field<2>(static_cast<std::size_t>(body.nodes()), 0.01));
    double const stable = stable_step(body);
    CentralDifference small{{.step = stable / 2}},
        large{{.step = 4 * stable, .check_interval = 32}};
    auto const height_of_centre = [&] {
      double sum = 0, mass = 0;
      auto const u = body.displacements();
      for (std::size_t i = 0; i < u.size(); ++i) {
        sum += body.parts().layout.mass_list()[i] * u[i][1];
        mass += body.parts().layout.mass_list()[i];
      }
      return sum / mass;
    };
    small(body, 50);
    double const rise = (height_of_centre() + square(body.time()) / 2) / body.time();

    large(body, 200);

    // Whatever steps were taken, the centre of mass falls freely: y = v t - t²/2.
    CHECK(large.retries() >= 1);
    double const t = body.time();
    CHECK(t > 0);
    CHECK(height_of_centre() == Approx(rise * t - t * t / 2).epsilon(1e-10));
  });
}

TEST_CASE("a blow-up that smaller steps do not cure is an error, and the body stays good",
          "[solver]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto body = body_of<Rubber>(backend, strip());
    body.clamp(body.mesh().boundary("left"));
    body.set_gravity({0, -0.05});
    CentralDifference step{{.step = 100 * stable_step(body), .check_interval = 32}};

    CHECK_THROWS_AS(step(body, 4000), Error);

    CHECK(finite(body));
    CHECK(largest(body.displacements()) < 1);
  });
}

TEST_CASE("what a user does to a body is not taken for a blow-up", "[solver]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = strip();
    auto body = body_of<Rubber>(backend, mesh);
    body.clamp(mesh.boundary("left"));
    CentralDifference step{{.check_interval = 10}};
    step(body, 5);
    FieldOf<2> kick(mesh.nodes.size(), {0, 0.1});

    body.set_velocities(kick);
    step(body, 20);
    body.set_gravity({0, -0.1});
    step(body, 20);
    body.set_gravity({0, 0.1});
    step(body, 20);
    body.set_load(20, {0.01, 0});
    step(body, 20);
    body.set_displacements(uniform(mesh.nodes, Tensor<double, 2>{{{0.1, 0}, {0, 0}}}));
    step(body, 20);

    CHECK(step.retries() == 0);
    CHECK(body.steps() == 105);
    CHECK(strain_energy(body) > 1e-4);
  });
}

TEST_CASE("one integrator may step two bodies in turn", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = strip();
    auto still = body_of<Rubber>(backend, mesh), fast = body_of<Rubber>(backend, mesh);
    fast.set_velocities(Random(1).field<2>(mesh.nodes.size(), 0.1));
    CentralDifference step{{.check_interval = 4}};

    for (int k = 0; k < 20; ++k) {
      step(still);
      step(fast);
    }

    CHECK(step.retries() == 0);
    CHECK(largest(still.displacements()) == 0);
    CHECK(largest(fast.displacements()) > 1e-3);
    CHECK(fast.steps() == 20);
  });
}

TEST_CASE("a body does not inherit the halved step of the one before", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto first = body_of<Rubber>(backend, strip());
    first.clamp(first.mesh().boundary("left"));
    first.set_gravity({0, -0.05});
    double const given = 4 * stable_step(first);
    CentralDifference step{{.step = given, .check_interval = 32}};
    step(first, 200);
    REQUIRE(step.step() < given);
    auto still = body_of<Rubber>(backend, strip());

    step(still);

    CHECK(step.step() == given);
  });
}

TEST_CASE("a state that is not finite from the start is an error", "[solver]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = strip();
    auto body = body_of<Rubber>(backend, mesh);
    // A node pushed through its elements: the law is not defined there.
    FieldOf<2> u(mesh.nodes.size());
    u[13] = {3, 3};
    body.set_displacements(u);
    CentralDifference step{};

    CHECK_THROWS_AS(step(body), Error);
  });
}

TEST_CASE("options that make no sense are refused", "[solver]") {
  CHECK_THROWS_AS(CentralDifference({.safety = 0}), Error);
  CHECK_THROWS_AS(CentralDifference({.safety = 1.5}), Error);
  CHECK_THROWS_AS(CentralDifference({.safety = NAN}), Error);
  CHECK_THROWS_AS(CentralDifference({.step = -1}), Error);
  CHECK_THROWS_AS(CentralDifference({.step = NAN}), Error);
  CHECK_THROWS_AS(CentralDifference({.step = INFINITY}), Error);
  CHECK_THROWS_AS(CentralDifference({.check_interval = 0}), Error);
  CHECK_THROWS_AS(CentralDifference({.refresh_interval = 0}), Error);
  CHECK_THROWS_AS(CentralDifference({.energy_growth = NAN}), Error);
  CHECK_NOTHROW(CentralDifference({.safety = 1}));
}

}  // namespace pliant::test::blow_up_suite
