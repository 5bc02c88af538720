#pragma once

#include <set>

#include "support/formulations.hpp"

// What the energy check of CentralDifference sees, and what it does not take for growth.
namespace pliant::test::energy_check_suite {

template <template <class> class Law>
using Square = Formulation<Quad4, Gauss<2>, Law>;
inline constexpr Elastic gel{1e5, 0.3, 1e3};

template <class F, class B>
auto gel_body(B const& backend, Mesh<Quad4> const& mesh) {
  return body_of<F>(backend, mesh, gel);
}
template <class TheBody>
double kept_energy(TheBody& body) {
  return leapfrog_energy(body.parts()).kept() - booked_energy(body.parts());
}
template <class TheBody>
bool finite_state(TheBody& body) {
  return std::isfinite(largest(body.displacements())) && std::isfinite(largest(body.velocities()));
}

/// Runs a body to a time with default options. What leapfrog keeps must stay within what these allow of the
/// start in all that is not undone later, or the run throws and leaves a state that does.
template <class TheBody>
void check_energy_over(TheBody& body, double time) {
  struct Seen {
    std::int64_t steps;
    double energy, gain;
  };
  CentralDifferenceOptions const options{};
  CentralDifference step(options);
  double const start = total_energy(body);
  std::vector<Seen> seen;
  std::int64_t checked = 0;
  bool threw = false;
  auto const look = [&] {
    std::erase_if(seen, [&](Seen const& undone) { return undone.steps >= body.steps(); });
    seen.push_back(
        {body.steps(), strain_energy(body) + kinetic_energy(body), kept_energy(body) - start});
  };
  look();
  try {
    while (body.time() < time) {
      checked = step(body, options.check_interval / 4).checked;
      look();
    }
  } catch (Error const&) {
    threw = true;
    look();
  }
  double scale = 0, largest_gain = 0;
  for (auto const& [steps, energy, gain] : seen)
    if (steps <= checked) {
      scale = std::max(scale, energy);
      largest_gain = std::max(largest_gain, gain);
    }
  INFO("retries " << step.retries() << ", step " << body.steps());
  CHECK(finite_state(body));
  CHECK(checked > 0);
  CHECK(largest_gain <= 1.5 * options.energy_drift * scale);  // of which some is between checks
  if (threw) CHECK(seen.back().gain <= options.energy_drift * scale);
}

template <class F, class B>
void impact_keeps_energy(B const& backend, double speed) {
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {6, 6}});
  auto body = gel_body<F>(backend, mesh);
  body.clamp(mesh.boundary("left"));
  body.set_velocities(FieldOf<2>(mesh.nodes.size(), {-speed, 0}));
  check_energy_over(body, 15);
}
template <class F, class B>
void noise_keeps_energy(B const& backend, double cells) {
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {16, 4}});
  auto body = gel_body<F>(backend, mesh);
  body.set_displacements(Random(1).field<2>(mesh.nodes.size(), cells * 0.0625));
  check_energy_over(body, 15);
}

TEST_CASE("no energy creeps in where a block hits a wall", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    SECTION("neo-Hookean") { impact_keeps_energy<Square<NeoHookean>>(backend, 2); }
    SECTION("stable neo-Hookean") { impact_keeps_energy<Square<StableNeoHookean>>(backend, 4); }
    SECTION("corotated") { impact_keeps_energy<Square<Corotated>>(backend, 4); }
  });
}

TEST_CASE("no energy creeps in from noise", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    SECTION("Saint Venant-Kirchhoff") {
      noise_keeps_energy<Square<SaintVenantKirchhoff>>(backend, 0.3);
    }
    SECTION("corotated") { noise_keeps_energy<Square<Corotated>>(backend, 1); }
  });
}

TEST_CASE("the step shrinks while a block is compressed, before its energy grows", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {16, 4}});
    auto body = gel_body<Square<NeoHookean>>(backend, mesh);
    body.hold(mesh.boundary("left"), 1);
    FieldOf<2> v;
    for (auto const& x : mesh.nodes) v.push_back({-5 * x[0], 0});
    body.set_velocities(v);
    CentralDifference step{{.check_interval = 1 << 20, .refresh_interval = 1 << 20}};
    step(body);
    double const first = step.step(), start = kept_energy(body), scale = kinetic_energy(body);

    double smallest = first, gain = 0, margin = INFINITY;
    while (body.time() < 0.2) {
      step(body);
      smallest = std::min(smallest, step.step());
      gain = std::max(gain, std::abs(kept_energy(body) - start));
      margin = std::min(margin, stable_step(body) / step.step());
    }

    CHECK(smallest < 0.85 * first);
    CHECK(margin > 0.8);  // of the stable step; 0.5 with the first step
    CHECK(gain < 0.005 * scale);
    CHECK(step.retries() == 0);
  });
}

TEST_CASE("rough motion at a stable step is not taken for a blow-up", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    // The highest mode: at nine tenths of the stable step its total energy swings by a factor of 5.
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
    for (double fraction : {0.9, 0.94}) {
      auto body = gel_body<Square<Hooke>>(backend, mesh);
      FieldOf<2> v;
      for (auto const& x : mesh.nodes) {
        double const sign = std::lround(8 * (x[0] + x[1])) % 2 == 0 ? 1 : -1;
        v.push_back({0.01 * sign, 0.003 * sign});
      }
      body.set_velocities(v);
      CentralDifference step{{.safety = fraction, .check_interval = 3}};

      step(body, 2000);

      CHECK(step.retries() == 0);
    }
  });
}

/// What a user does to a body between steps.
enum class Touch { nothing, velocities, group, mesh, hold };

template <class B>
void touched_run(B const& backend, Touch touch, double fraction, double peak) {
  CAPTURE(static_cast<int>(touch), fraction, peak);
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {16, 4}});
  Body body{backend, mesh, gel, Group<Square<Hooke>>{}, Group<Square<Corotated>>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -0.981});
  double const stable = stable_step(body);
  CentralDifference step{{.step = fraction * stable}};
  int const every = touch == Touch::mesh ? 40 : 100;
  try {
    for (int k = 0; k < 600; ++k) {
      step(body);
      if (k % every != every - 1) continue;
      if (touch == Touch::velocities) body.set_velocities(body.velocities());
      if (touch == Touch::group)
        body.template assign<Square<Hooke>>({static_cast<Index>(k / every)});
      if (touch == Touch::mesh) (void)refine(body, {{static_cast<Index>(k / every)}}, 2);
      if (touch == Touch::hold) body.hold(std::vector<Index>{0}, 3);
    }
  } catch (Error const&) {
    // Said aloud; what must not be is growth without a word.
  }
  CHECK(finite_state(body));
  CHECK(strain_energy(body) + kinetic_energy(body) < 1.5 * peak);
  CHECK(kept_energy(body) < 0.1 * peak);  // from 0
}

TEST_CASE("a call says which of its steps were looked at", "[solver]") {
  MainBackend const backend;
  auto body = gel_body<Square<NeoHookean>>(backend, regular_mesh<Quad4>(2));
  CentralDifference step{{.check_interval = 40}};
  CHECK(step(body, 30).checked == 0);
  CHECK(step(body, 30).checked == 40);
  CHECK(step(body, 20).checked == 40);
  CHECK(step(body, 1).checked == 80);

  // Beyond the stable step it takes some steps until that is seen; they are not vouched for.
  auto wild = gel_body<Square<NeoHookean>>(backend, regular_mesh<Quad4>(2));
  wild.set_velocities(Random(1).field<2>(static_cast<std::size_t>(wild.nodes()), 1));
  CentralDifference hasty{{.step = 40 * stable_step(wild), .watch_interval = 1 << 20}};
  auto const done = hasty(wild, 200);
  CHECK_FALSE(finite_state(wild));
  CHECK(done.checked == 0);
  CHECK(hasty(wild, 100).rolled_back);
}

TEST_CASE("a state can be looked at before it is used", "[solver]") {
  auto body = gel_body<Square<NeoHookean>>(MainBackend{}, regular_mesh<Quad4>(2));
  body.set_velocities(Random(1).field<2>(static_cast<std::size_t>(body.nodes()), 1));
  CentralDifference hasty{{.step = 40 * stable_step(body), .watch_interval = 1 << 20}};
  auto const before = hasty.check(body);
  CHECK(before.checked == 0);
  CHECK_FALSE(before.rolled_back);

  hasty(body, 200);
  REQUIRE_FALSE(finite_state(body));
  auto const after = hasty.check(body);
  CHECK(after.rolled_back);
  CHECK(after.steps == -200);
  CHECK(after.checked == body.steps());
  CHECK(finite_state(body));
  CHECK(hasty.retries() == 1);
}

TEST_CASE("a fall of the energy between two looks is seen", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
    auto const run = [&](CentralDifferenceOptions const& options, double share) {
      auto body = gel_body<Square<Hooke>>(backend, mesh);
      body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 0.01));
      double const start = kinetic_energy(body);
      CentralDifference step(options);
      step(body, 10);
      step.check(body);
      body.parts().state.energy_by_hand += share * start;  // which the body has not got
      return step.check(body).rolled_back;
    };
    CHECK(run({}, 0.03));
    CHECK_FALSE(run({}, 0.01));
    CHECK_FALSE(run({.energy_drift = 1e9}, 0.03));
  });
}

TEST_CASE("the step does not follow each swing of a body", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    // It spins and breathes, so that its stable step goes up and down by a twentieth.
    auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
    FieldOf<2> v;
    for (auto const& X : mesh.nodes) v.push_back({-20 * (X[1] - 0.5), 20 * (X[0] - 0.5)});
    auto const distinct_steps = [&](double hysteresis) {
      auto own = body_of<Square<SaintVenantKirchhoff>>(backend, mesh, {2e6, 0.3, 1e3});
      own.set_velocities(v);
      CentralDifference step{{.safety = 0.5, .refresh_interval = 64, .hysteresis = hysteresis}};
      std::set<double> sizes;
      for (int k = 0; k < 100; ++k) {
        step(own, 64);
        sizes.insert(step.step());
      }
      return std::pair(sizes.size(), std::abs(external_work(own).steps));
    };
    auto const [few, little] = distinct_steps(0.1);
    auto const [many, much] = distinct_steps(0);
    CHECK(few < 8);
    CHECK(many > 50);
    // What leapfrog keeps depends on the step: following it adds up.
    CHECK(little < 0.3 * much);
  });
}

TEST_CASE("a state that is touched again and again does not blind the check", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {16, 4}});
    auto body = gel_body<Square<Hooke>>(backend, mesh);
    body.clamp(mesh.boundary("left"));
    body.set_gravity({0, -0.981});
    CentralDifference step;
    double peak = 0;
    while (body.time() < 3) {
      step(body, 16);
      peak = std::max(peak, strain_energy(body) + kinetic_energy(body));
    }
    for (double fraction : {1.05, 1.3, 2.0})
      for (Touch touch :
           {Touch::nothing, Touch::velocities, Touch::group, Touch::mesh, Touch::hold})
        touched_run(backend, touch, fraction, peak);
  });
}

TEST_CASE("without its thresholds the check would miss a blow-up", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const run = [&](CentralDifferenceOptions options) {
      auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
      auto body = gel_body<Square<Hooke>>(backend, mesh);
      body.clamp(mesh.boundary("left"));
      body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 0.01));
      double const start = kinetic_energy(body);
      options.step = 1.5 * stable_step(body);
      options.check_interval = 8;
      CentralDifference step(options);
      step(body, 40);
      double const energy = (strain_energy(body) + kinetic_energy(body)) / start;
      return std::pair(energy, step.retries());
    };

    auto const [watched, retries] = run({});
    auto const [unwatched, none] = run({.energy_growth = 1e9, .energy_drift = 1e9});
    auto const [by_growth, some] = run({.energy_drift = 1e9});

    CHECK(watched < 3);
    CHECK(retries > 0);
    CHECK(by_growth < 3);
    CHECK(some > 0);
    CHECK(unwatched > 1e4);
    CHECK(none == 0);
  });
}

TEST_CASE("what leapfrog keeps is compared with the start, however slowly it grows", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    // A dashpot of negative rate, as it were: each call adds a ten-thousandth without being booked.
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
    auto body = gel_body<Square<Hooke>>(backend, mesh);
    body.clamp(mesh.boundary("left"));
    body.set_velocities(Random(1).field<2>(mesh.nodes.size(), 0.01));
    CentralDifference step{{.check_interval = 8}};
    step(body);
    double const start = kept_energy(body);
    auto& state = body.parts().state;

    auto const grow = [&] {
      for (int k = 0; k < 1000; ++k) {
        step(body, 8);
        state.energy_by_hand -= 1e-3 * start;
      }
    };

    CHECK_THROWS_AS(grow(), Error);
    CHECK(kept_energy(body) - start < 0.05 * start);
  });
}

}  // namespace pliant::test::energy_check_suite
