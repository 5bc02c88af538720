#pragma once

#include <complex>
#include <cstdlib>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <Eigen/Eigenvalues>

#include <pliant/solver/local_steps.hpp>

#include "support/formulations.hpp"
#include "support/repeatable.hpp"
#include "support/small_patches.hpp"

// Each element has its own time step.
namespace pliant::test::local_steps_suite {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
inline constexpr Elastic gel{1e5, 0.3, 1e3};
/// Patches of so many elements, where those of a backend would hold all of a small mesh.
template <Index Size>
using Patches = SmallPatches<double, Size>;

/// Quadrilaterals split at random, up to three times where they were split before, with hanging nodes.
template <class F, class B>
auto graded_body(B const& backend, unsigned seed, Elastic const& material) {
  Random random(seed);
  int const across = 5 + static_cast<int>(random.below(4)),
            up = 2 + static_cast<int>(random.below(3));
  auto mesh = mesh::rectangle(
      {.size = {0.25 * across * (1.1 + 0.5 * random()), 0.25 * up}, .cells = {across, up}});
  auto body = body_of<F>(backend, shaken(std::move(mesh), 0.05, seed), material);
  auto const rounds = 1 + random.below(3);
  for (std::size_t round = 0; round < rounds; ++round) {
    std::size_t const count = body.mesh().template elements<Quad4>().size();
    std::size_t const from = round == 0 ? 0 : count - 4;
    refine(body, {{static_cast<Index>(from + random.below(count - from))}});
  }
  return body;
}

/// Without looks at the state, with levels once chosen.
inline LocalSteps unwatched(double safety = 0.8) {
  return LocalSteps{{.safety = safety,
                     .check_interval = 1 << 28,
                     .refresh_interval = 1 << 28,
                     .watch_interval = 1 << 28}};
}

/// |eigenvalue| − 1 of a macro step, the largest. The step is u ↦ P u + Q v with u₊ + u₋ = 2 P u, since it is the
/// same backwards in time, and Hooke's law is linear.
template <class TheBody>
double growth_of_macro_step(TheBody& body, LocalSteps& step) {
  std::vector<std::pair<std::size_t, std::size_t>> free;
  auto const held = held_directions(body.parts(), std::span(body.state().prescribed->conditions));
  auto const& layout = body.parts().layout;
  for (std::size_t i = 0; i < layout.mass_list().size(); ++i)
    for (std::size_t k = 0; k < 2; ++k)
      if (layout.mass_list()[i] > 0 &&
          !(held[static_cast<std::size_t>(layout.internal_of(static_cast<Index>(i)))] >> k & 1))
        free.emplace_back(i, k);
  auto const n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd p(n, n);
  FieldOf<2> const rest(layout.mass_list().size(), Point<2>{});
  step(body);  // chooses levels
  for (Eigen::Index column = 0; column < n; ++column) {
    auto u = rest;
    auto const [node, direction] = free[static_cast<std::size_t>(column)];
    u[node][direction] = 1;
    body.set_velocities(rest);
    body.set_displacements(u);
    body.parts().has_checkpoint = true;  // no look at the state
    step(body);
    auto const after = body.displacements();
    for (Eigen::Index row = 0; row < n; ++row) {
      auto const [i, k] = free[static_cast<std::size_t>(row)];
      p(row, column) = after[i][k];
    }
  }
  double growth = -1;
  Eigen::VectorXcd const cosines = p.eigenvalues();
  for (std::complex<double> c : cosines) {
    auto const root = std::sqrt(c * c - 1.0);
    growth = std::max({growth, std::abs(c + root) - 1, std::abs(c - root) - 1});
  }
  return growth;
}

TEST_CASE("macro steps are stable on graded meshes with hanging nodes", "[solver]") {
  std::vector<unsigned> seeds{2, 3, 5, 7, 11, 13};
  if (char const* const wanted = std::getenv("PLIANT_GRADED_MESHES")) {  // twice so many in all
    seeds.resize(static_cast<std::size_t>(std::atoi(wanted)));
    std::iota(seeds.begin(), seeds.end(), 1u);
  }
  REQUIRE(!seeds.empty());
  auto const with_patches = [&](auto const& backend, double largest_share) {
    double least_share = 1;
    for (unsigned const seed : seeds) {
      CAPTURE(seed);
      auto body = graded_body<Linear>(backend, seed, {1, 0.3, 1});
      body.clamp(body.mesh().boundary("left"));
      auto step = unwatched();

      double const growth = growth_of_macro_step(body, step);

      CHECK(growth < 1e-7);
      least_share = std::min(least_share, body.parts().schedule->evaluations);
    }
    CHECK(least_share < largest_share);
  };
  with_patches(Patches<1>{}, 0.7);
  with_patches(Patches<4>{}, 0.8);
}

/// A strip of rubber with all that pulls at it, whose right end is split twice.
template <class B>
auto loaded_strip(B const& backend) {
  auto body = body_of<Rubber>(
      backend, shaken(mesh::rectangle({.size = {1, 0.25}, .cells = {12, 3}}), 0.01), gel);
  refine(body, {{35}});
  refine(body, {{static_cast<Index>(body.mesh().template elements<Quad4>().size() - 1)}});
  body.clamp(body.mesh().boundary("left"));
  body.set_gravity({0, -3});
  body.set_damping(0.7);
  body.set_load(20, {1, 2});
  body.drive(body.mesh().boundary("right"),
             [](Point<2> const& x, double t) -> Point<2> {
               return {0, 0.3 * x[0] * t * t};
             },
             {.directions = 2});
  body.press(body.mesh().boundary("top"), 80);
  return body;
}

TEST_CASE("local steps are of second order, with all that pulls at a body", "[solver]") {
  Patches<1> const backend;
  auto const run = [&](double safety, int steps, double& time) {
    auto body = loaded_strip(backend);
    auto step = unwatched(safety);
    step(body, steps / 2);
    step(body, steps / 2);
    CHECK(body.parts().schedule->finest >= 2);
    CHECK(body.parts().schedule->evaluations < 0.85);
    CHECK(body.parts().schedule->term_level >= 1);
    time = body.time();
    return std::pair{body.displacements(), body.velocities()};
  };
  double time = 0, same = 0;
  auto const coarse = run(0.4, 16, time), middle = run(0.2, 32, same), fine = run(0.1, 64, same);
  auto exact = loaded_strip(backend);
  CentralDifference step{{.step = time / 4000, .check_interval = 1 << 28}};
  step(exact, 4000);
  auto const error = [&](auto const& of) { return difference(of.first, exact.displacements()); };

  CHECK(same == Approx(time).epsilon(1e-12));
  CHECK(error(coarse) < 0.01 * largest(exact.displacements()));
  CHECK(error(coarse) / error(middle) == Approx(4).epsilon(0.1));
  CHECK(error(middle) / error(fine) == Approx(4).epsilon(0.1));
}

TEST_CASE("local steps take elements of several types and laws", "[solver]") {
  using Triangles = Formulation<Tri3, Gauss<1>, NeoHookean>;
  using Turning = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
  auto mesh = mixed_mesh(10);
  for (auto& p : mesh.nodes) p[0] = std::pow(p[0] + 0.3, 2.2);  // smaller to the left
  auto const make = [&] {
    Body body{Patches<2>{}, mesh, gel, Group<Triangles>{}, Group<Rubber>{}, Group<Turning>{}};
    body.template assign<Turning>({0, 3, 6, 9, 12, 15});
    body.clamp(mesh.boundary("right"));
    body.set_gravity({0, -3});
    return body;
  };
  double time = 0;
  auto const run = [&](double safety, int steps) {
    auto body = make();
    LocalSteps step{{.safety = safety}};
    step(body, steps);
    CHECK(body.parts().schedule->finest >= 2);
    CHECK(body.parts().schedule->evaluations < 0.8);
    time = body.time();
    return body.displacements();
  };
  auto const coarse = run(0.4, 20), fine = run(0.2, 40);
  auto body = make();
  CentralDifference step{{.step = time / 2000}};
  step(body, 2000);
  auto const exact = body.displacements();

  CHECK(difference(coarse, exact) < 1e-3 * largest(exact));
  CHECK(difference(coarse, exact) / difference(fine, exact) == Approx(4).epsilon(0.1));
}

TEST_CASE("local steps keep linear momentum, and energy for long", "[solver]") {
  Patches<1> const backend;
  auto body = graded_body<Rubber>(backend, 3, gel);
  FieldOf<2> v;
  for (auto const& x : body.mesh().nodes)
    v.push_back({0.2 - 0.4 * x[1], 0.4 * x[0] + 0.2 * std::sin(3 * x[0])});
  body.set_velocities(v);
  auto const moved = [&] {
    Point<2> sum{};
    auto const now = body.velocities();
    for (std::size_t i = 0; i < now.size(); ++i)
      for (std::size_t k = 0; k < 2; ++k) sum[k] += body.parts().layout.mass_list()[i] * now[i][k];
    return sum;
  };
  auto const before = moved();
  double const energy = total_energy(body);
  auto step = unwatched();

  step(body, 2);
  REQUIRE(body.parts().schedule->evaluations < 0.8);
  double least = energy, most = energy, strain = 0;
  for (int k = 0; k < 100; ++k) {
    step(body, 5);
    least = std::min(least, total_energy(body));
    most = std::max(most, total_energy(body));
    strain = std::max(strain, strain_energy(body));
  }

  double const mass = 1e3 * 0.5;  // at least, kg
  CHECK(std::abs(moved()[0] - before[0]) < 1e-13 * 0.2 * mass);
  CHECK(std::abs(moved()[1] - before[1]) < 1e-13 * 0.2 * mass);
  INFO(most - least << " of " << strain);
  CHECK(strain > 0.01 * energy);
  CHECK(most - least < 0.05 * strain);
}

TEST_CASE("the work of what pulls at a body with local steps is booked", "[solver]") {
  Patches<1> const backend;
  auto const lost = [&](double safety, int steps) {
    auto body = loaded_strip(backend);
    auto step = unwatched(safety);
    step(body, 0);
    double const before = total_energy(body) - booked_energy(body.parts());
    step(body, steps);
    auto const work = external_work(body);
    CHECK(work.damping < -0.01);
    CHECK(std::abs(work.motions) > 0.01);
    CHECK(std::abs(work.pressures) > 0.01);
    return total_energy(body) - booked_energy(body.parts()) - before;
  };

  double const coarse = lost(0.4, 40), fine = lost(0.1, 160);

  INFO(coarse << " " << fine);
  CHECK(std::abs(coarse) < 0.01);
  CHECK(std::abs(fine) < 0.1 * std::abs(coarse));
}

TEST_CASE("energy that comes with other levels is booked", "[solver]") {
  using F = Formulation<Quad9, Gauss<3>, StableNeoHookean>;
  auto body =
      body_of<F>(Reference<double>{}, mesh::rectangle<Quad9>({.size = {1, 1}, .cells = {3, 3}}),
                 {2e6, 0.3, 1e3});
  FieldOf<2> to_the_middle;
  for (auto const& x : body.mesh().nodes) to_the_middle.push_back({0.5 - x[0], 0.5 - x[1]});
  body.set_displacements(to_the_middle);
  body.set_damping(50);
  LocalSteps step{{.safety = 0.8}};
  step(body, 0);
  double const before = total_energy(body) - booked_energy(body.parts());

  step(body, 600);

  REQUIRE(kinetic_energy(body) < 1e-3 * before);
  CHECK(external_work(body).steps > 0.02 * before);
  CHECK(std::abs(total_energy(body) - booked_energy(body.parts()) - before) < 0.05 * before);
}

/// A strip whose right half is split once, and there its right quarter again.
template <class F, class B>
auto split_strip(B const& backend) {
  auto body = body_of<F>(backend, mesh::rectangle({.size = {1, 0.25}, .cells = {16, 4}}), gel);
  for (double from : {0.5, 0.75}) {
    std::vector<Index> right;
    auto const& mesh = body.mesh();
    for (std::size_t e = 0; e < mesh.template elements<Quad4>().size(); ++e) {
      double least = 1;
      for (Index node : mesh.template elements<Quad4>()[e])
        least = std::min(least, mesh.nodes[static_cast<std::size_t>(node)][0]);
      if (least >= from - 1e-9) right.push_back(static_cast<Index>(e));
    }
    refine(body, {right});
  }
  body.clamp(body.mesh().boundary("left"));
  return body;
}

/// The level at which each element steps, in internal order.
template <class TheBody>
std::vector<int> levels_of(TheBody const& body) {
  auto const& elements = body.parts().layout.template table<Quad4>().elements;
  std::vector<int> levels;
  auto const bounds = elements.patch_bounds();
  for (std::size_t p = 0; p + 1 < bounds.size(); ++p)
    levels.resize(static_cast<std::size_t>(bounds[p + 1]),
                  body.parts().schedule->patch_levels[0][p]);
  return levels;
}
/// By how much the step of some element is longer than it is stable by itself.
template <class TheBody>
double largest_excess(TheBody& body, LocalSteps const& step) {
  double largest = 0;
  auto& parts = body.parts();
  auto const levels = levels_of(body);
  double least = std::numeric_limits<double>::infinity();
  for (auto shares : {detail::MassShares::own, detail::MassShares::by_rows}) {
    largest = 0;
    (void)detail::bound_elements(parts, shares);
    auto const bounds =
        download<typename TheBody::scalar>(parts.layout.template table<Quad4>().scratch);
    for (std::size_t e = 0; e < bounds.size(); ++e)
      largest = std::max(largest, step.macro_step() * std::exp2(-levels[e]) / 2 *
                                      std::sqrt(static_cast<double>(bounds[e])));
    least = std::min(least, largest);
  }
  return least;
}

TEST_CASE("what pulls where elements are coarse gives the impulse of its time", "[solver]") {
  Patches<1> const backend;
  auto body = body_of<Rubber>(backend, mesh::rectangle({.size = {6, 1}, .cells = {12, 2}}), gel);
  for (int round = 0; round < 2; ++round)
    refine(body, {{static_cast<Index>(body.mesh().template elements<Quad4>().size()) - 1}});
  double const pressure = 1e-3;  // Pa, and so small that the side stays where it is
  body.press(body.mesh().boundary("left"), pressure);
  auto step = unwatched();
  step(body, 40);
  auto const& schedule = *body.parts().schedule;
  REQUIRE(schedule.term_level < schedule.finest);

  double pushed = 0;
  auto const now = body.velocities();
  for (std::size_t i = 0; i < now.size(); ++i)
    pushed += body.parts().layout.mass_list()[i] * now[i][0];

  CHECK(pushed == Approx(pressure * body.time()).epsilon(1e-5));  // on 1 m
}

TEST_CASE("fine elements have two rings of their level around them", "[solver]") {
  auto body = split_strip<Rubber>(Patches<1>{});
  auto step = unwatched();
  step(body);
  auto const& parts = body.parts();
  auto const levels = levels_of(body);
  auto const own = download<StepLevel>(std::get<0>(parts.state.elements).step_levels);
  auto const& mesh = body.mesh();
  auto const& user_element = parts.layout.template table<Quad4>().user_elements();
  // Two elements touch where they read the same free node.
  std::vector<std::vector<Index>> read(own.size());
  for (std::size_t e = 0; e < own.size(); ++e)
    for (Index node : mesh.template elements<Quad4>()[static_cast<std::size_t>(user_element[e])])
      parts.state.topology->interpolation.for_each_master(
          node, [&](Index master, double) { read[e].push_back(master); });
  auto const around = [&](std::vector<int> const& of) {
    auto highest = of;
    for (std::size_t a = 0; a < of.size(); ++a)
      for (std::size_t b = 0; b < of.size(); ++b)
        if (std::ranges::find_first_of(read[a], read[b]) != read[a].end())
          highest[a] = std::max(highest[a], of[b]);
    return highest;
  };

  CHECK(levels == around(around({own.begin(), own.end()})));
  CHECK(std::ranges::max(levels) == 2);
  CHECK(std::ranges::min(levels) == 0);
  CHECK(largest_excess(body, step) < 0.8 + 1e-9);
}

TEST_CASE("rounding of a body that is turned and at rest is no growth", "[solver]") {
  auto const turned = [](auto const& step_with) {
    auto body =
        body_of<Rubber>(MainBackend{}, shaken(regular_mesh<Quad4>(4), 0.1, 3), {2e6, 0.3, 1e3});
    double const c = std::cos(2.1), s = std::sin(2.1);
    body.set_displacements(
        uniform(body.mesh().nodes, Tensor<double, 2>{{{c - 1, -s}, {s, c - 1}}}));
    auto step = step_with;
    step(body, 3000);
    CHECK(step.retries() == 0);
    CHECK(largest(body.velocities()) < 1e-6);
  };
  turned(LocalSteps{});
  turned(CentralDifference{});
}

TEST_CASE("levels follow elements that stiffen, between macro steps", "[solver]") {
  using Backends = std::tuple<Patches<1>, Patches<20>, Patches<64>, MainBackend>;
  on_each_backend<Backends>([]<class B>(B const& backend) {
    auto body = split_strip<Rubber>(backend);
    // Its left, coarse part is pressed together to a half, not so far that the strip buckles.
    body.drive(body.mesh().boundary("right"), [](double t) -> Point<2> {
      return {-0.3 * std::min(1.0, t / 2), 0};
    });
    LocalSteps step;
    step(body, 8);
    double const before = step.macro_step();
    auto const first = levels_of(body);
    double worst = 0;
    bool changed = false;
    while (body.time() < 2) {
      step(body, 8);
      worst = std::max(worst, largest_excess(body, step));
      changed = changed || levels_of(body) != first || step.macro_step() != before;
    }

    CHECK(changed);
    CHECK(worst < 0.85);
    CHECK(step.retries() == 0);
  });
}

TEST_CASE("a level goes down only when its step would be stable with some room", "[solver]") {
  std::vector<double> const squared_frequency{1, 4, 4.5, 15, 17, 64};
  std::vector<StepLevel> level{1, 1, 0, 2, 1, 3};
  detail::AssignLevel<double> const assign{squared_frequency.data(), level.data(), 1, 1.1};

  for (Index e = 0; e < 6; ++e) assign(e);

  // Half the step at 4, a quarter at 16: what needs more gets it at once.
  CHECK(level == std::vector<StepLevel>{1, 1, 2, 2, 3, 3});
}

TEST_CASE("elements that move to a stiffer law take its level before they step", "[solver]") {
  using Stiff = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
  auto body = [] {
    Body made{Patches<1>{}, mesh::rectangle({.size = {1, 0.25}, .cells = {16, 4}}), gel,
              Group<Rubber>{}, Group<Stiff>{SaintVenantKirchhoff<double>::from({4e6, 0.3, 1e3})}};
    made.clamp(made.mesh().boundary("left"));
    made.set_gravity({0, -1});
    return made;
  }();
  LocalSteps step;
  step(body, 3);
  REQUIRE(body.parts().schedule->finest == 0);
  double const before = step.macro_step();

  // As a check on the device would: nothing else is told.
  auto& tags = std::get<0>(body.parts().state.elements).tags;
  auto moved = download<Tag>(tags);
  moved[5] = 1;
  tags.upload(moved);
  step(body, 1);

  CHECK(step.macro_step() * std::exp2(-levels_of(body)[5]) < 0.3 * before);
  CHECK(largest_excess(body, step) < 0.8 + 1e-9);
}

TEST_CASE("a run with local steps goes on from a file with the same bits", "[solver]") {
  on_each_backend<std::tuple<Patches<1>, MainBackend>>([]<class B>(B const& backend) {
    auto const make = [&] {
      auto body = split_strip<Rubber>(backend);
      body.set_gravity({0, -2});
      return body;
    };
    auto straight = make();
    LocalSteps step{{.check_interval = 7, .watch_interval = 3}};
    step(straight, 20);
    std::stringstream file;
    straight.save(file);
    auto other = make();
    other.load(file);
    LocalSteps again{{.check_interval = 7, .watch_interval = 3}};

    step(straight, 20);
    again(other, 20);

    CHECK(difference(straight.displacements(), other.displacements()) <= between_runs(1e-12));
    CHECK(difference(straight.velocities(), other.velocities()) <= between_runs(1e-11));
    CHECK(straight.time() == other.time());
    CHECK(levels_of(straight) == levels_of(other));
  });
}

TEST_CASE("no macro steps leave the state as it is", "[solver]") {
  auto body = split_strip<Rubber>(Patches<1>{});
  body.set_gravity({0, -2});
  LocalSteps step;
  step(body, 5);
  body.set_velocities(FieldOf<2>(body.mesh().nodes.size(), Point<2>{}));  // by hand
  auto const saved = [&] {
    std::ostringstream bytes;
    body.save(bytes);
    return bytes.str();
  };
  (void)body.velocities();
  auto const before = saved();

  Advanced const done = step(body, 0);

  CHECK(done.steps == 0);
  CHECK(saved() == before);
}

TEST_CASE("a macro step that goes wrong is rolled back", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = split_strip<Rubber>(backend);
    body.set_gravity({0, -1});
    LocalSteps step{{.check_interval = 16}};
    step(body, 40);
    auto u = body.parts().layout.padded(body.displacements());
    for (auto& x : u) x = NAN;
    body.parts().state.u.upload(u);

    Advanced const done = step(body, 20);

    CHECK(done.rolled_back);
    CHECK(step.retries() == 1);
    CHECK(body.steps() <= 40);
    step(body, 40);
    CHECK(std::isfinite(total_energy(body)));
  });
}

TEST_CASE("a motion that throws within a macro step leaves the last whole one", "[solver]") {
  Patches<1> const backend;
  bool fails = true;
  auto const driven = [&](Motion<2> motion) {
    auto body = split_strip<Rubber>(backend);
    body.drive(body.mesh().boundary("right"), std::move(motion));
    return body;
  };
  auto const pull = [](double t) -> Point<2> { return {0.1 * t, 0}; };
  auto failing = driven([&](double t) -> Point<2> {
    if (fails && t > 0.05) throw std::runtime_error("no signal");
    return pull(t);
  });
  auto smooth = driven(pull);
  auto step = unwatched(), other = unwatched();

  CHECK_THROWS_AS(step(failing, 60), std::runtime_error);
  CHECK(failing.time() == Approx(0.05).margin(step.macro_step()));
  CHECK(failing.time() < 0.05);
  fails = false;
  other(smooth, static_cast<int>(failing.steps()));

  CHECK(difference(failing.displacements(), smooth.displacements()) == 0);
  CHECK(difference(failing.velocities(), smooth.velocities()) == 0);
  CHECK(failing.time() == smooth.time());
}

TEST_CASE("an integrator takes over from another one", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = split_strip<Rubber>(backend);
    body.set_gravity({0, -1});
    LocalSteps local;
    CentralDifference global;
    double const before = total_energy(body);
    for (int k = 0; k < 5; ++k) {
      local(body, 4);
      global(body, 9);
    }

    CHECK(body.steps() == 65);
    CHECK(strain_energy(body) > 0.01);
    CHECK(total_energy(body) - before == Approx(0).margin(0.02 * strain_energy(body)));
  });
}

TEST_CASE("options of local steps that cannot be meant are refused", "[solver]") {
  CHECK_THROWS_WITH(LocalSteps{{.safety = 0.9}}, says("0.85"));
  CHECK_THROWS_WITH(LocalSteps{{.safety = 0}}, says("safety"));
  CHECK_THROWS_AS(LocalSteps{{.macro_step = -1}}, Error);
  CHECK_THROWS_AS(LocalSteps{{.macro_step = INFINITY}}, Error);
  CHECK_THROWS_AS(LocalSteps{{.check_interval = 0}}, Error);
  CHECK_THROWS_AS(LocalSteps{{.energy_growth = NAN}}, Error);
  auto body = split_strip<Rubber>(Patches<1>{});
  LocalSteps longest{{.macro_step = 1e6}};
  CHECK_THROWS_WITH(longest(body), says("macro step of"));
  LocalSteps step;
  CHECK_THROWS_WITH(step(body, -1), says("0 or more"));
}

TEST_CASE("with one level local steps are central differences", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = shaken(mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}}), 0.02);
    auto const make = [&] {
      auto body = body_of<Rubber>(backend, mesh, gel);
      body.clamp(mesh.boundary("left"));
      body.set_gravity({0, -3});
      body.set_load(20, {1, 2});
      body.set_damping(0.7);
      body.drive(mesh.boundary("right"),
                 [](double t) -> Point<2> {
                   return {0.1 * t * t, 0};
                 },
                 {.directions = 1});
      body.press(mesh.boundary("top"), 50);
      return body;
    };
    auto local = make(), global = make();
    double const dt = 0.4 * stable_step(global);
    LocalSteps step{{.macro_step = dt}};
    CentralDifference other{{.step = dt}};

    step(local, 40);
    step(local, 60);
    other(global, 100);

    REQUIRE(local.parts().schedule->finest == 0);
    CHECK(difference(local.displacements(), global.displacements()) < 1e-13);
    CHECK(difference(local.velocities(), global.velocities()) < 1e-12);
    CHECK(local.time() == Approx(global.time()).epsilon(1e-14));
    auto const work = external_work(local), same = external_work(global);
    CHECK(work.damping == Approx(same.damping).epsilon(1e-11));
    CHECK(work.motions == Approx(same.motions).epsilon(1e-11));
    CHECK(work.pressures == Approx(same.pressures).epsilon(1e-11));
  });
}

}  // namespace pliant::test::local_steps_suite
