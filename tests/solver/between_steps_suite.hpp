#pragma once

#include <sstream>

#include "support/formulations.hpp"

// What a user may do to a body between the calls of an integrator.
namespace pliant::test::between_steps_suite {

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
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
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
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
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

/// Pulls a node back to where it rests.
template <class T>
struct Spring {
  static constexpr int nodes = 1, dim = 2;
  T stiffness;  // N/m
  template <class S>
  PLIANT_HOST_DEVICE S energy(Matrix<S, 1, 2> const&, Matrix<S, 1, 2> const& u) const {
    return stiffness / 2 * (u(0, 0) * u(0, 0) + u(0, 1) * u(0, 1));
  }
};

TEST_CASE("a body that is made stiffer by hand is stepped within its new stable step", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const check = [&](bool watched, auto const& stiffen) {
      Body body{backend, beam(), gel, Group<Linear>{},
                Group<Stiff>{{SaintVenantKirchhoff<double>::from({4e7, 0.3, 1e3})}}};
      body.clamp(body.mesh().boundary("left"));
      if (!watched) body.press(body.mesh().boundary("right"), 1);
      body.set_gravity({0, -1});
      CentralDifference step;
      step(body, 10);
      double const before = step.step();
      stiffen(body);

      Advanced const done = step(body, 100);

      CHECK(done.steps == 100);
      CHECK(step.retries() == 0);
      CHECK(step.step() < 0.5 * before);
      CHECK(step.step() <= stable_step(body));
      CHECK(body.state().integrator.slower == 1);
    };
    for (bool watched : {true, false}) {
      check(watched, [](auto& body) {
        std::vector<Index> all(16);
        for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
        body.template assign<Stiff>(all);
      });
      check(watched, [](auto& body) {
        body.add(std::vector<std::array<Index, 1>>{{tip}}, Spring<double>{1e7});
      });
    }
  });
}

TEST_CASE("a step that cannot be chosen is asked for again", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = body_of<Linear>(backend, beam(), gel);
    std::vector<Index> all(static_cast<std::size_t>(body.nodes()));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
    auto const held = body.clamp(all);
    body.set_gravity({0, -10});
    CentralDifference step;

    CHECK_THROWS_WITH(step(body, 10), says("every node is held"));
    CHECK_THROWS_WITH(step(body, 10), says("every node is held"));
    CHECK(body.steps() == 0);
    body.release(held);
    step(body, 500);

    CHECK(body.time() > 100 * stable_step(body));
    CHECK(body.displacements()[tip][1] == Approx(-5 * square(body.time())).epsilon(1e-9));
    CHECK_THROWS_WITH(take_steps(body.parts(), 0, 1), says("positive"));
  });
}

TEST_CASE("gravity, damping and loads outlast a roll-back to before they were set", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = held_beam(backend);
    body.set_velocities(FieldOf<2>(static_cast<std::size_t>(body.nodes()), {0, 1e-3}));
    CentralDifference step{{.step = 1.2 * stable_step(body), .watch_interval = 1 << 20}};
    step(body, 100);
    body.set_gravity({0, -1});
    body.set_damping(0.5);
    body.set_load(tip, {1, -2});
    auto const kept = [&] {
      return leapfrog_energy(body.parts()).kept() - booked_energy(body.parts());
    };

    Advanced done;
    while (!done.rolled_back && body.steps() < 1000) done = step(body, 100);

    REQUIRE(done.rolled_back);
    CHECK(body.state().gravity == Point<2>{0, -1});
    CHECK(body.state().damping == 0.5);
    CHECK(nodal_loads(body)[tip] == Point<2>{1, -2});
    CHECK(kept() == Approx(body.state().integrator.first_energy).epsilon(1e-9));
    step(body, 2000);
    CHECK(body.displacements()[tip][1] < -1e-3);
  });
}

TEST_CASE("a loaded run follows the options of the integrator that goes on with it", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = held_beam(backend), loaded = held_beam(backend);
    body.set_gravity({0, -1});
    CentralDifference first{{.step = 1e-3}};
    first(body, 20);
    auto const resume = [&](CentralDifferenceOptions options) {
      std::stringstream file;
      body.save(file);
      loaded.load(file);
      CentralDifference step(options);
      step(loaded, 20);
      return step.step();
    };

    CHECK(resume({.step = 1e-3}) == 1e-3);
    CHECK(resume({.step = 2e-3}) == 2e-3);
    CHECK(resume({.safety = 0.5}) == Approx(0.5 * stable_step(loaded)));
    first(body, 10);
    CHECK(first.step() == 1e-3);

    CentralDifference safer{{.safety = 0.4}};
    safer(body, 20);
    CHECK(resume({.safety = 0.8}) == Approx(0.8 * stable_step(loaded)));
  });
}

TEST_CASE("integrators that take turns book no work", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = held_beam(backend);
    body.set_gravity({0, -1});
    CentralDifference first{{.step = 1e-3}}, second{{.step = 1e-3}};
    first(body);
    double const start = external_work(body).steps;
    for (int k = 0; k < 100; ++k) {
      second(body);
      first(body);
    }
    CHECK(external_work(body).steps == start);
    CHECK(leapfrog_energy(body.parts()).kept() - booked_energy(body.parts()) ==
          Approx(0).margin(1e-9 * strain_energy(body)));
  });
}

}  // namespace pliant::test::between_steps_suite
