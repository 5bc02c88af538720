#pragma once

#include "support/formulations.hpp"

// Energies that are not finite: of laws that cannot invert, where an element is folded.
namespace pliant::test::folded_elements_suite {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Turning = Formulation<Quad4, Gauss<2>, Corotated>;

/// Where an element begins, along x.
struct Begin {
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return e.rest(0, 0);
  }
};

template <class B>
auto rubber_square(B const& backend) {
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
  Body body{backend, mesh, soft, Group<Rubber>{}, Group<Turning>{}};
  body.clamp(mesh.boundary("left"));
  return body;
}
template <class TheBody>
void fold(TheBody& body) {
  auto u = body.displacements();
  u[8] = {-0.6, -0.6};
  body.set_displacements(u);
}
/// How many changes of energy were not finite.
template <class TheBody>
double unbooked_changes(TheBody const& body) {
  auto const& parts = body.parts();
  return detail::booked(parts, download<double>(parts.state.work)).not_finite;
}

TEST_CASE("a rule leaves a law that cannot invert, and the run goes on", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    Adaptation rescue{when<Rubber>(AreaRatio{}).above(0.5).template become<Turning>()};
    auto body = rubber_square(backend);
    CentralDifference step{{.check_interval = 4}};
    SECTION("before the first step") {}
    SECTION("between steps") { step(body, 5); }
    SECTION("where elements had moved before") {
      body.set_velocities(Random(1).field<2>(9, 0.01));
      Adaptation some{when<Rubber>(Begin{}).below(-0.25).template become<Turning>()};
      step(body, 5);
      some.now(body);
      step(body, 5);
    }
    fold(body);
    REQUIRE_FALSE(std::isfinite(total_energy(body)));
    double const before = booked_energy(body.parts());

    rescue.now(body);

    CHECK(std::isfinite(total_energy(body)));
    CHECK(booked_energy(body.parts()) == before);
    CHECK(unbooked_changes(body) == (body.steps() > 0 ? 2 : 1));  // of all together too
    CHECK_NOTHROW(step(body, 20));
    CHECK(step.retries() == 0);
    CHECK(std::isfinite(booked_energy(body.parts())));
  });
}

TEST_CASE("an element that folds between two checks is rescued by a rule", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    Adaptation rescue{when<Rubber>(AreaRatio{}).above(0.5).template become<Turning>()};
    auto body = rubber_square(backend);
    CentralDifference step{{.check_interval = 4}};
    step(body, 5);
    auto v = body.velocities();
    v[8] = {-0.6 / step.step(), -0.6 / step.step()};
    body.set_velocities(v);
    step(body);
    REQUIRE_FALSE(std::isfinite(strain_energy(body)));

    rescue.now(body);

    step(body, 4);
    CHECK(step.retries() == 0);
    CHECK(unbooked_changes(body) == 1);
    CHECK(std::isfinite(booked_energy(body.parts())));
  });
}

TEST_CASE("loads set while an element is folded leave the books finite", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = rubber_square(backend);
    CentralDifference step;
    step(body, 5);
    auto const straight = body.displacements();
    fold(body);
    body.set_load(8, {1, 0});
    CHECK(unbooked_changes(body) == 1);
    body.set_displacements(straight);
    body.set_load(8, {});
    CHECK_NOTHROW(step(body, 300));
    CHECK(std::isfinite(booked_energy(body.parts())));
  });
}

TEST_CASE("refining a body with a folded element leaves the books finite", "[adaptation]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = rubber_square(backend);
    CentralDifference step;
    step(body, 5);
    fold(body);

    refine(body, {{3}});  // which is folded

    CHECK(std::isfinite(booked_energy(body.parts())));
    CHECK(external_work(body).by_hand == 0);
    for (auto const& entry : ledger(body)) CHECK(std::isfinite(entry.strain_energy));
    body.set_displacements(FieldOf<2>(static_cast<std::size_t>(body.nodes())));
    CHECK_NOTHROW(step(body, 300));
  });
}

}  // namespace pliant::test::folded_elements_suite
