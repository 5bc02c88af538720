#pragma once

#include <sstream>

#include <pliant/body/compare.hpp>
#include <pliant/solver/implicit.hpp>

#include "adaptation/plane_bodies.hpp"

// What implicit integrators keep of a run stands in the body's state; steps that fold are told.
namespace pliant::test::implicit_state_suite {

/// A refined body that swings, is drawn at its left side, pulled and damped.
template <class B>
auto swinging_body(B const& backend) {
  auto body = Body{backend, mesh::rectangle({.size = {1, 0.5}, .cells = {4, 2}}),
                   Elastic{2e5, 0.3, 1000}, Group<QuadRubber>{}, Group<QuadLinear>{}};
  body.drive(body.mesh().boundary("left"),
             [](double t) {
               return Point<2>{0.01 * std::sin(40 * t), 0};
             },
             {.name = "shake"});
  refine(body, {{3, 4}});
  body.set_gravity({0, -10});
  body.set_load(4, {200, 0});
  body.set_damping(2);
  return body;
}
constexpr ImplicitOptions options{.step = 4e-3};

template <class A, class B>
void check_same(A const& a, B const& b) {
  CHECK(first_difference(a.state(), b.state()) == "");
  CHECK(a.displacements() == b.displacements());
  CHECK(largest(a.displacements()) > 1e-3);
}

TEST_CASE("a run that is saved and loaded goes on with the same bits", "[solver][state]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto whole = swinging_body(backend), first = swinging_body(backend),
         second = swinging_body(backend);
    Implicit step{Newmark{}, options}, other{Newmark{}, options}, anew{Newmark{}, options};
    step(whole, 3);
    other(first, 3);
    REQUIRE(!whole.state().topology->interpolation.empty());
    std::stringstream file(std::ios::in | std::ios::out | std::ios::binary);
    first.save(file);
    second.load(file);
    CHECK(first_difference(first.state(), second.state()) == "");

    step(whole, 3);
    anew(second, 3);

    check_same(whole, second);
  });
}

TEST_CASE("a run that is rolled back goes on with the same bits", "[solver][state]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto whole = swinging_body(backend), body = swinging_body(backend);
    Implicit step{Newmark{}, options}, other{Newmark{}, options};
    step(whole, 3);
    other(body, 3);
    keep_checkpoint(body.parts());
    other(body, 2);
    roll_back(body.parts());
    CHECK(first_difference(whole.state(), body.state()) == "");
    step(whole, 3);
    other(body, 3);
    check_same(whole, body);
  });
}

TEST_CASE("a copied state has what goes on", "[solver][state]") {
  MainBackend const backend;
  auto body = swinging_body(backend);
  Implicit step{Newmark{}, options};
  step(body, 2);
  typename decltype(body)::parts_type::state_type copy;
  copy_state(backend, body.state(), copy);
  CHECK(same_state(copy, body.state()));
  step(body);
  CHECK(first_difference(copy.implicit, body.state().implicit) == "accelerations");
}

TEST_CASE("changes by hand and of the mesh leave nothing to go on with", "[solver][state]") {
  MainBackend const backend;
  auto body = swinging_body(backend);
  Implicit step{Newmark{}, options};
  auto const goes_on = [&] {
    bool const goes = !body.state().implicit.empty();
    step(body);
    return goes;
  };
  CHECK_FALSE(goes_on());
  CHECK(goes_on());
  body.set_velocities(body.velocities());
  CHECK_FALSE(goes_on());
  refine(body, {{0}});
  CHECK_FALSE(goes_on());
  body.assign<QuadLinear>({1});
  CHECK_FALSE(goes_on());
  CentralDifference{}(body, 1);
  CHECK_FALSE(goes_on());
  CHECK(goes_on());
  CHECK_FALSE(body.state().integrator.active);
}

TEST_CASE("accelerations follow loads, damping and groups", "[solver][state]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const change = GENERATE(0, 1, 2, 3, 4);
    CAPTURE(change);
    auto const make = [&] {
      Body body{backend, mesh::rectangle({.size = {1, 0.5}, .cells = {4, 2}}),
                Elastic{2e5, 0.3, 1000}, Group<QuadRubber>{}, Group<QuadLinear>{}};
      body.clamp(body.mesh().boundary("left"));
      body.set_gravity({0, -10});
      return body;
    };
    auto body = make(), twin = make();
    for (auto* each : {&body, &twin}) {
      Implicit{Newmark{}, options}(*each, 10);
      if (each == &twin)  // what begins anew knows what there is
        each->set_velocities(each->velocities());
      if (change == 1) each->set_gravity({0, 10});
      if (change == 2) each->set_damping(100);
      if (change == 3) each->set_load(4, {0, 300});
      if (change == 4)
        Adaptation{when<QuadRubber>(AreaRatio{}).above(-1.0).template become<QuadLinear>()}.now(
            *each);
      Implicit{Newmark{}, options}(*each);
    }
    double const size = largest(body.velocities());
    CHECK(difference(body.velocities(), twin.velocities()) < 1e-8 * size);
    if (change == 4) CHECK(body.template groups_of<Quad4>() == std::vector<Tag>(8, 1));
  });
}

template <class F>
auto pressed_block(double speed = 60) {
  Body body{Reference<double>{}, mesh::rectangle({.size = {1, 1}, .cells = {2, 1}}), soft,
            Group<F>{}};
  body.hold(body.mesh().boundary("left"), 0b01);
  body.hold(body.mesh().boundary("bottom"), 0b10);
  auto v = body.velocities();
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = {-speed * body.mesh().nodes[i][0], 0};
  body.set_velocities(v);
  return body;
}

TEST_CASE("a step that folds the body is refused, and it stays as it was", "[solver]") {
  using Folding = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
  auto body = pressed_block<Folding>();
  ImplicitOptions coarse{.step = 5e-3};
  int good = 0;
  FieldOf<2> before;
  auto const run = [&] {
    Implicit step{Newmark{}, coarse};
    for (; good < 100; ++good) {
      before = body.displacements();
      auto const report = step(body);
      CHECK(report.steps == 1);
      CHECK(report.least_J.value > 0);
    }
  };
  CHECK_THROWS_WITH(run(), says("Newmark: the step to time") && says("folds the body: det F") &&
                               says("Quad4 element") && says("accept_folded"));
  CHECK(good > 0);
  CHECK(body.steps() == good);
  CHECK(body.displacements() == before);

  coarse.accept_folded = true;
  auto const report = Implicit{Newmark{}, coarse}(body, 2);
  CHECK(report.steps == 2);
  CHECK_FALSE(report.least_J.value > 0);
  CHECK(report.least_J.number >= 0);
  CHECK(report.time == body.time());

  // What many steps come to counts, not the last alone.
  auto again = pressed_block<Folding>();
  auto const whole = Implicit{Newmark{}, coarse}(again, good + 2);
  CHECK(whole.least_J.value == report.least_J.value);
}

TEST_CASE("the least det F is that of all steps of a call", "[solver]") {
  using Folding = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
  auto body = pressed_block<Folding>(0.5), twin = pressed_block<Folding>(0.5);
  Implicit step{Newmark{}, {.step = 5e-2}}, single{Newmark{}, {.step = 5e-2}};
  auto const whole = step(body, 30);
  double least = 1, last = 1;
  for (int k = 0; k < 30; ++k) {
    last = single(twin).least_J.value;
    least = std::min(least, last);
  }
  CHECK(whole.least_J.value == least);
  CHECK(least < 0.9);
  CHECK(last > least + 0.01);  // it swings back
}

TEST_CASE("a fold is nothing to a linear law, and is told all the same", "[solver]") {
  auto body = pressed_block<Formulation<Quad4, Gauss<2>, Hooke>>();
  auto const report = Implicit{Newmark{}, {.step = 5e-3}}(body, 6);
  CHECK(report.steps == 6);
  CHECK(report.least_J.value < 0);
  CHECK(report.iterations >= 6);
  CHECK(report.factorisations >= 1);
  CHECK(report.residual < 1e-6);
}

}  // namespace pliant::test::implicit_state_suite
