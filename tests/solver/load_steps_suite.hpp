#pragma once

#include <pliant/solver/newton.hpp>

#include "adaptation/plane_bodies.hpp"

// Load steps that adapt, and how fast Newton's method ends.
namespace pliant::test::load_steps_suite {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

struct Way {
  std::vector<detail::LoadStep> taken;
  int backward = 0, count = 0;
};
/// Goes a way on which steps fail that are longer than `longest(step)`.
template <class Longest>
Way go(NewtonOptions const& options, Longest const& longest) {
  Way way;
  way.count = detail::follow_loads(
      options,
      [&](detail::LoadStep const& step) {
        if (step.to - step.from > longest(step)) throw detail::LoadStepFailed("too long");
        way.taken.push_back(step);
      },
      [&] { ++way.backward; });
  return way;
}

TEST_CASE("load steps are halved where they fail, grow again, and leave no gap", "[solver]") {
  for (int load_steps : {1, 3, 4}) {
    auto const narrow = [](detail::LoadStep const& step) {
      return step.to > 0.3 && step.from < 0.4 ? 0.04 : 0.4;
    };
    auto const way = go({.load_steps = load_steps}, narrow);
    CHECK(way.count == std::ssize(way.taken));
    CHECK(way.backward > 0);
    double end = 0, shortest = 1, longest = 0;
    for (auto const& step : way.taken) {
      CHECK(step.from == end);
      end = step.to;
      shortest = std::min(shortest, step.to - step.from);
      longest = std::max(longest, step.to - step.from);
    }
    CHECK(end == 1);
    CHECK(shortest <= 0.04);
    CHECK(shortest > 0.02);
    CHECK(longest > 0.15);
    auto const& last = way.taken.back();
    CHECK(last.to - last.from > 2 * shortest);
  }
}

TEST_CASE("load steps that succeed are as many as were asked for", "[solver]") {
  for (int load_steps : {1, 7}) {
    auto const way = go({.load_steps = load_steps}, [](detail::LoadStep const&) { return 1.0; });
    CHECK(way.count == load_steps);
    CHECK(way.backward == 0);
  }
}

TEST_CASE("a load step is halved so often as allowed", "[solver]") {
  for (int halvings : {0, 1, 5}) {
    NewtonOptions const options{.load_halvings = halvings};
    double const shortest = std::ldexp(1.0, -halvings);
    auto const way = go(options, [&](auto const&) { return shortest; });
    CHECK(way.count == 1 << halvings);
    for (auto const& step : way.taken) CHECK(step.to - step.from == shortest);
    CHECK_THROWS_AS(go(options, [&](auto const&) { return 0.9 * shortest; }), Error);
  }
}

/// A cantilever of rubber under a pull at its tip that one load step does not reach.
template <class B>
auto pulled_down(B const& backend) {
  auto const mesh = mesh::rectangle({.size = {1, 0.1}, .cells = {16, 2}});
  Body body{backend, mesh, Elastic{2e5, 0.3, 1000}, Group<Rubber>{}};
  body.clamp(mesh.boundary("left"));
  body.set_load(50, {0, -250});
  return body;
}

TEST_CASE("a body that one load step does not bring to rest takes shorter ones", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    for (auto linear : {LinearMethod::direct, LinearMethod::matrix_free}) {
      NewtonOptions options{.load_halvings = 0, .max_iterations = 10, .linear = linear};
      auto body = pulled_down(backend);
      CHECK_THROWS_WITH(solve_static(body, options), says("no convergence between 0 and 1"));
      CHECK(largest(body.displacements()) == 0);

      options.load_halvings = 5;
      auto const report = solve_static(body, options);

      CHECK(report.load_steps > 1);
      auto slowly = pulled_down(backend);
      solve_static(slowly, {.load_steps = 20, .load_halvings = 0, .linear = linear});
      double const size = largest(slowly.displacements());
      CHECK(size > 0.3);
      CHECK(difference(body.displacements(), slowly.displacements()) < 1e-8 * size);
    }
  });
}

TEST_CASE("an end that is driven too far for one load step takes shorter ones", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    for (auto linear : {LinearMethod::direct, LinearMethod::matrix_free}) {
      auto body = pulled_down(backend);
      body.drive(body.mesh().boundary("right"), [](double) { return Point<2>{-0.1, 0.7}; });
      NewtonOptions const options{.max_iterations = 6, .linear = linear};
      auto const report = solve_static(body, options);
      CHECK(report.load_steps > 1);
      for (Index i : nodes_of(body.mesh().boundary("right"))) {
        auto const u = body.displacements()[static_cast<std::size_t>(i)];
        CHECK(u[0] == -0.1);
        CHECK(u[1] == 0.7);
      }
      // At rest: nothing is left to do.
      CHECK(solve_static(body, {.tolerance = 1e-9, .linear = linear}).iterations == 0);
    }
  });
}

TEST_CASE("a load step that fails leaves nothing behind", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    constexpr bool exact = std::same_as<typename B::Recording, HostRecording>;  // sums too
    for (auto linear : {LinearMethod::direct, LinearMethod::matrix_free}) {
      auto const solved = [&](int load_steps, int halvings) {
        auto body = pulled_down(backend);
        body.drive(body.mesh().boundary("right"), [](double) { return Point<2>{-0.1, 0.7}; });
        auto const report = solve_static(body, {.load_steps = load_steps,
                                                .load_halvings = halvings,
                                                .max_iterations = 6,
                                                .linear = linear});
        CHECK(report.load_steps == 2);
        return body.displacements();
      };
      CHECK(difference(solved(1, 1), solved(2, 0)) < (exact ? 1e-300 : 1e-12));
    }
  });
}

TEST_CASE("Newton's method converges quadratically near a solution", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    for (auto linear : {LinearMethod::direct, LinearMethod::matrix_free}) {
      auto body = pulled_down(backend);
      auto const report =
          solve_static(body, {.load_steps = 8, .tolerance = 1e-13, .linear = linear});
      auto const& r = report.residuals;
      REQUIRE(r.size() >= 4);
      CHECK(r.back() == report.residual);
      // Each residual is at most a constant times the square of the one before, down to rounding.
      int seen = 0;
      for (std::size_t k = 1; k + 1 < r.size(); ++k) {
        if (!(r[k] < 1e-2 * r[0])) continue;
        CHECK(r[k + 1] < std::max(20 * r[k] * r[k] / r[0], 1e-11 * r[0]));
        ++seen;
      }
      CHECK(seen > 0);
    }
  });
}

TEST_CASE("load steps refuse halvings that cannot be", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = pulled_down(backend);
    CHECK_THROWS_WITH(solve_static(body, {.load_halvings = -1}), says("load_halvings -1"));
    CHECK_THROWS_WITH(solve_static(body, {.load_halvings = 31}), says("load_halvings 31"));
  });
}

}  // namespace pliant::test::load_steps_suite
