#pragma once

#include <stdexcept>

#include <pliant/law/decorators/viscosity.hpp>
#include <pliant/solver/local_steps.hpp>

#include "support/formulations.hpp"
#include "support/repeatable.hpp"

// A roll-back brings back all that a run changes, and an integrator says what it did.
namespace pliant::test::roll_back_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Turning = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Viscous = Formulation<Quad4, Gauss<2>, Prony<NeoHookean>::template law>;
inline constexpr Elastic gel{1e5, 0.3, 1e3};

inline Mesh<Quad4> gel_mesh() { return mesh::rectangle({.size = {1, 0.25}, .cells = {16, 4}}); }

inline auto turning_rules() {
  auto const deformed = largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{});
  return Adaptation{when<Linear>(deformed).above(0.10).become<Turning>(),
                    when<Turning>(deformed).below(0.05).become<Linear>()};
}

TEST_CASE("statistics and ledger are right after roll-backs", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    int retries = 0;
    for (double fraction : {1.5, 2.0, 3.0, 4.0, 6.0}) {
      CAPTURE(fraction);
      Body body{backend, gel_mesh(), gel, Group<Linear>{}, Group<Turning>{}};
      body.clamp(body.mesh().boundary("left"));
      body.set_gravity({0, -9.81});
      auto adapt = turning_rules().every(1);
      CentralDifference step{{.step = fraction * stable_step(body)}};
      try {
        for (int k = 0; k < 1000; ++k) {
          step(body);
          adapt(body);
        }
      } catch (Error const&) {
        // They must be right then too.
      }
      retries += step.retries();
      auto const spent = element_steps<Quad4>(body);
      CHECK(spent[0] >= 0);
      CHECK(spent[1] >= 0);
      CHECK(spent[0] + spent[1] == 64.0 * static_cast<double>(body.steps()));
      double moved = 0, counted = 0, changed = 0;
      for (auto const& entry : ledger(body)) {
        moved += entry.elements;
        changed += std::abs(entry.strain_energy) + std::abs(entry.kinetic_energy);
      }
      for (int n : switch_counts<Quad4>(body)) counted += n;
      CHECK(moved == counted);
      CHECK(changed < 1e4);  // of 600 J; what is thrown away had up to 1e300
    }
    CHECK(retries > 0);
  });
}

/// What can be seen of a body.
template <class TheBody>
auto observed(TheBody& body) {
  auto& parts = body.parts();
  std::vector<double> numbers{body.time(),
                              static_cast<double>(body.steps()),
                              strain_energy(body),
                              kinetic_energy(body),
                              potential_energy(body),
                              adaptation_energy(body),
                              external_work(body).changed_loads,
                              external_work(body).damping,
                              external_work(body).by_hand,
                              external_work(body).steps,
                              body.state().damping,
                              body.state().step_size,
                              static_cast<double>(ledger(body).size()),
                              static_cast<double>(body.state().integrator.next_check)};
  auto const add = [&](auto const& list) {
    for (auto x : list) numbers.push_back(static_cast<double>(x));
  };
  auto const add_points = [&](auto const& list) {
    for (auto const& point : list) add(point);
  };
  add_points(body.displacements());
  add_points(body.velocities());
  add_points(body.forces());
  add_points(nodal_loads(body));
  add(body.state().gravity);
  add(body.template groups_of<Quad4>());
  add(element_steps<Quad4>(body));
  add(switch_counts<Quad4>(body));
  parts.for_each_type([&](auto const&, auto const& elements) {
    add(download<typename TheBody::scalar>(elements.internal_variables));
  });
  FieldOf<1> rows;
  for (double x : numbers) rows.push_back({x});
  return rows;
}

TEST_CASE("roll-back brings back all that a run changes", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
    Body body{backend, mesh, gel, Group<Rubber>{},
              Group<Viscous>{typename Viscous::template law<double>{
                  NeoHookean<double>::from(gel), {0.5}, {0.05}}}};
    body.clamp(mesh.boundary("left"));
    body.set_gravity({0, -5});
    body.set_load(20, {1, 2});
    body.set_damping(0.1);
    Adaptation forth{when<Rubber>(EdgeLengthRatio{}).above(0.01).template become<Viscous>()};
    Adaptation back{when<Viscous>(EdgeLengthRatio{}).below(0.05).template become<Rubber>()};
    CentralDifference step;
    step(body, 20);
    forth.now(body);
    step(body, 20);

    keep_checkpoint(body.parts());
    auto const before = observed(body);
    auto const go_on = [&] {
      step(body, 7);
      back.now(body);
      step(body, 6);
      forth.now(body);
      step(body, 5);
      return observed(body);
    };
    auto const first = go_on();
    body.set_gravity({1, 5});
    body.set_load(20, {-3, 2});
    body.set_damping(3);
    step(body, 3);
    CHECK(difference(before, observed(body)) > 0.01);
    roll_back(body.parts());

    double const rounding = between_runs(1e-9);
    CHECK(difference(observed(body), before) <= rounding);
    CHECK(difference(go_on(), first) <= rounding);
  });
}

/// A load that grows with the square of the time, set anew before each step.
template <class B>
auto loaded_run(B const& backend, double dt_over_stable, double& dt, int& retries,
                bool& told_each) {
  auto body = body_of<Rubber>(backend, gel_mesh(), gel);
  body.clamp(body.mesh().boundary("left"));
  CentralDifference step{{.step = dt > 0 ? dt : dt_over_stable * stable_step(body)}};
  told_each = true;
  while (body.steps() < 512) {
    double const now = body.time();
    std::int64_t const at = body.steps();
    body.set_load(50, {0, 400 * now * now});
    Advanced const done = step(body);
    told_each = told_each && done.time == body.time() && done.steps == body.steps() - at &&
                done.rolled_back == (done.steps < 0);
    if (!done.rolled_back) told_each = told_each && done.steps == 1 && done.step == step.step();
  }
  dt = step.step();
  retries = step.retries();
  return body.displacements()[50][1];
}

TEST_CASE("a call that is rolled back behind its begin says so, and its caller sets loads anew",
          "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    double dt = 0;
    int retries = 0, none = 0;
    bool told = false, told_again = false;

    double const rolled_back = loaded_run(backend, 1.5, dt, retries, told);
    double const straight = loaded_run(backend, 0, dt, none, told_again);

    CHECK(retries >= 1);
    CHECK(none == 0);
    CHECK(told);
    CHECK(told_again);
    CHECK(rolled_back == Approx(straight).epsilon(between_runs(1e-9) + 1e-9));
  });
}

TEST_CASE("a long call redoes inside itself what it rolls back", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = body_of<Rubber>(backend, gel_mesh(), gel);
    body.clamp(body.mesh().boundary("left"));
    body.set_gravity({0, -1});
    CentralDifference step{{.step = 2 * stable_step(body)}};

    Advanced const done = step(body, 700);

    CHECK(step.retries() >= 1);
    CHECK_FALSE(done.rolled_back);
    CHECK(done.steps == 700);
    CHECK(body.steps() == 700);
    CHECK(done.time == body.time());
  });
}

/// Two bodies that have moved alike.
template <class TheBody>
void check_alike(TheBody& a, TheBody& b) {
  CHECK(difference(a.displacements(), b.displacements()) <= between_runs(1e-12));
  CHECK(difference(a.velocities(), b.velocities()) <= between_runs(1e-11));
  CHECK(a.steps() == b.steps());
  CHECK(a.time() == Approx(b.time()).epsilon(1e-14));
}

TEST_CASE("a motion that throws leaves the last whole step, from which a run goes on", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
    bool fails = true;
    auto const driven = [&](Motion<2> motion) {
      auto body = body_of<Rubber>(backend, mesh, gel);
      body.clamp(mesh.boundary("left"));
      body.set_gravity({0, -1});
      body.drive(mesh.boundary("right"), std::move(motion));
      return body;
    };
    auto const pull = [](double t) -> Point<2> { return {0.1 * t, 0}; };
    auto failing = driven([&](double t) -> Point<2> {
      if (fails && t > 0.05) throw std::runtime_error("no signal");
      return pull(t);
    });
    auto smooth = driven(pull);
    CentralDifference step{{.step = 2e-3}}, other{{.step = 2e-3}};

    CHECK_THROWS_AS(step(failing, 60), std::runtime_error);
    CHECK(failing.steps() >= 24);
    CHECK(failing.steps() <= 25);
    fails = false;
    step(failing, static_cast<int>(60 - failing.steps()));
    other(smooth, 60);

    check_alike(failing, smooth);
  });
}

#if !defined(__CUDACC__)
/// Throws when asked to.
struct Failing {
  bool const* fails;
  template <class State>
  auto operator()(State const& state) const {
    if (*fails) throw std::runtime_error("no criterion");
    return EdgeLengthRatio{}(state);
  }
};

TEST_CASE("a criterion that throws leaves a body from which a run goes on", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    bool fails = false;
    auto const rules = [&] {
      return Adaptation{when<Linear>(Failing{&fails}).above(0.02).template become<Turning>(),
                        when<Turning>(Failing{&fails}).below(0.01).template become<Linear>()};
    };
    auto const make = [&] {
      Body body{backend, mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}}), gel,
                Group<Linear>{}, Group<Turning>{}};
      body.clamp(body.mesh().boundary("left"));
      body.set_gravity({0, -1});
      return body;
    };
    auto disturbed = make(), smooth = make();
    auto adapt = rules(), other_adapt = rules();
    CentralDifference step, other;

    for (int k = 0; k < 40; ++k) {
      step(disturbed, 2);
      fails = true;
      CHECK_THROWS_AS(adapt.now(disturbed), std::runtime_error);
      fails = false;
      adapt.now(disturbed);
      other(smooth, 2);
      other_adapt.now(smooth);
    }

    check_alike(disturbed, smooth);
    CHECK(disturbed.template groups_of<Quad4>() == smooth.template groups_of<Quad4>());
    CHECK(adaptation_energy(disturbed) == adaptation_energy(smooth));
    CHECK(switch_counts<Quad4>(smooth)[0] > 0);
  });
}
#endif

TEST_CASE("a listener that throws leaves a refined body from which a run goes on", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const make = [&] {
      auto body =
          body_of<Rubber>(backend, mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}}), gel);
      body.clamp(body.mesh().boundary("left"));
      body.set_gravity({0, -5});
      return body;
    };
    auto disturbed = make(), smooth = make();
    disturbed.on_change([](auto const&) { throw std::runtime_error("no space"); });
    CentralDifference step, other;
    step(disturbed, 10);
    other(smooth, 10);

    CHECK_THROWS_AS(refine(disturbed, {{0, 5}}), std::runtime_error);
    refine(smooth, {{0, 5}});
    step(disturbed, 50);
    other(smooth, 50);

    check_alike(disturbed, smooth);
    CHECK(ledger(disturbed).size() == 1);
    CHECK(ledger(disturbed)[0].strain_energy == ledger(smooth)[0].strain_energy);
  });
}

TEST_CASE("a state that turns NaN is rolled back, or is an error that says where", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
    auto body = body_of<Rubber>(backend, mesh, gel);
    body.clamp(mesh.boundary("left"));
    body.set_gravity({0, -1});
    CentralDifference step{{.check_interval = 16}};
    step(body, 40);
    auto const spoil = [&] {
      auto u = body.parts().layout.padded(body.displacements());
      for (auto& x : u) x = NAN;
      body.parts().state.u.upload(u);
      forget_forces(body.parts());
    };
    spoil();

    CHECK_THROWS_WITH(stable_step(body), says("at time"));
    Advanced const done = step(body, 20);

    CHECK(step.retries() == 1);
    CHECK(done.rolled_back);
    CHECK(std::isfinite(total_energy(body)));
    CHECK(body.steps() <= 40);
    step(body, 40);
    CHECK(std::isfinite(total_energy(body)));

    body.set_gravity({0, -1});
    body.hold(std::vector<Index>{20}, 1);  // forgets the checkpoint
    spoil();
    CHECK_THROWS_WITH(step(body), says("went non-finite") && says("no earlier state"));
  });
}

template <class TheBody>
void spoil(TheBody& body) {
  auto u = body.parts().layout.padded(body.displacements());
  for (auto& x : u) x = NAN;
  body.parts().state.u.upload(u);
  forget_forces(body.parts());
}

/// Spoils a body, lets an integrator roll back, and returns the times of its steps before, behind that, and when so many
/// more have been good.
template <class Integrator, class TheBody>
std::array<double, 3> steps_around_trouble(TheBody& body, Integrator& integrate, int more) {
  auto const step = [&] {
    double const before = body.time();
    integrate(body);
    return body.time() - before;
  };
  integrate(body, 40);
  double const first = step();
  spoil(body);
  integrate(body, 20);
  CHECK(integrate.retries() == 1);
  double const second = step();
  integrate(body, more);
  return {first, second, step()};
}

TEST_CASE("a step that was halved gets longer again when all has been well for long enough",
          "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const make = [&] {
      auto body =
          body_of<Linear>(backend, mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}}), gel);
      body.clamp(body.mesh().boundary("left"));
      body.set_gravity({0, -1});
      return body;
    };
    for (int more : {40, 120}) {
      CAPTURE(more);
      auto body = make(), other = make();
      CentralDifference step{{.check_interval = 16}};
      LocalSteps local{{.check_interval = 16}};
      for (auto const& [before, behind, later] :
           {steps_around_trouble(body, step, more), steps_around_trouble(other, local, more)}) {
        CHECK(behind == Approx(before / 2).epsilon(0.02));
        CHECK(later == Approx(more < 64 ? behind : before).epsilon(0.02));
      }
      CHECK(step.retries() + local.retries() == 2);
    }
  });
}

TEST_CASE("longer steps are tried ever more seldom", "[solver]") {
  MainBackend const backend;
  auto body = body_of<Linear>(backend, mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}}), gel);
  body.clamp(body.mesh().boundary("left"));
  body.set_gravity({0, -1});
  CentralDifference step{{.check_interval = 16}};
  step(body, 40);
  double const whole = step.step();
  for (int steps : {64, 128, 256}) {
    spoil(body);
    step(body, 20);
    step(body);
    CHECK(step.step() == Approx(whole / 2).epsilon(0.02));
    auto const from = body.steps();
    while (step.step() < 0.9 * whole && body.steps() < from + 1000) step(body);
    CHECK(body.steps() - from <= steps);
    CHECK(body.steps() - from > steps - 48);
  }
  CHECK(step.retries() == 3);
}

TEST_CASE("a step that was given and went wrong stays halved", "[solver]") {
  MainBackend const backend;
  auto body = body_of<Linear>(backend, mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}}), gel);
  body.clamp(body.mesh().boundary("left"));
  body.set_gravity({0, -1});
  double const given = 1.5 * stable_step(body);
  CentralDifference step{{.step = given, .check_interval = 32}};
  step(body, 8000);
  CHECK(step.retries() == 1);
  CHECK(step.step() == given / 2);
}

}  // namespace pliant::test::roll_back_suite
