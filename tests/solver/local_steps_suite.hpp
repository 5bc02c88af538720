#pragma once

#include <complex>

#include <Eigen/Eigenvalues>

#include <pliant/solver/local_steps.hpp>

#include "support/formulations.hpp"
#include "support/repeatable.hpp"
#include "support/small_patches.hpp"

// Each element has its own time step.
namespace pliant::test {

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
  for (std::size_t i = 0; i < layout.mass_list.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k)
      if (layout.mass_list[i] > 0 &&
          !(held[static_cast<std::size_t>(layout.internal_node[i])] >> k & 1))
        free.emplace_back(i, k);
  auto const n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd p(n, n);
  FieldOf<2> const rest(layout.mass_list.size(), Point<2>{});
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
  auto const with_patches = [](auto const& backend, double largest_share) {
    double least_share = 1;
    for (unsigned seed : {2u, 3u, 5u, 7u, 11u, 13u}) {
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
      for (std::size_t k = 0; k < 2; ++k) sum[k] += body.parts().layout.mass_list[i] * now[i][k];
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

TEST_CASE("with one level local steps are central differences", "[solver]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
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

}  // namespace pliant::test
