#pragma once

#include "adaptation/criteria.hpp"
#include "support/small_patches.hpp"

// Meshes that keep an estimated error or a budget while what has to be resolved wanders.
namespace pliant::test::mesh_within_suite {

template <class E>
using Held = Formulation<E, Gauss<LinearSimplex<E> ? 1 : 2>, Hooke>;

template <class B, class M>
auto body_on(B const& backend, M const& mesh) {
  using E = Tri3;
  return Body{backend, mesh, soft, Group<Held<E>>{}};
}
inline auto coarse() { return mesh::rectangle<Tri3>({.size = {4, 1}, .cells = {16, 4}}); }

/// A bump around a place, of a width of a fifth.
template <class TheBody>
void bump(TheBody& body, double place, double size = 0.01) {
  auto u = body.mesh().nodes;
  for (auto& p : u) {
    double const apart = square(p[0] - place) + square(p[1] - 0.5);
    p = {size * std::exp(-apart / square(0.2)), 0};
  }
  body.set_displacements(u);
}
/// Looks until little changes.
template <class TheBody, class Adapt>
void look(TheBody& body, Adapt& adapt, double place, double size = 0.01) {
  for (int k = 0; k < 8; ++k) {
    bump(body, place, size);
    adapt.now(body);
  }
  bump(body, place, size);
}
template <class TheBody>
double count(TheBody const& body) {
  return static_cast<double>(body.mesh().template elements<Tri3>().size());
}

TEST_CASE("a mesh holds an error while what it resolves wanders", "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_on(backend, coarse());
    bump(body, 1);
    double const error = estimate(body, RecoveredStress{}) / 30;
    auto adapt = Adaptation{within<Held<Tri3>>(RecoveredStress{}, {.error = error})};
    std::vector<double> counts;
    for (double place : {1.0, 1.3, 1.6, 2.0, 2.5, 3.0}) {
      look(body, adapt, place);
      double const now = estimate(body, RecoveredStress{});
      CHECK(now < 1.1 * error);
      CHECK(now > 0.3 * error);  // no finer than asked
      counts.push_back(count(body));
    }
    // The same bump asks for as many elements wherever it is.
    CHECK(std::ranges::max(counts) < 1.3 * std::ranges::min(counts));
    look(body, adapt, 1, 0);
    CHECK(count(body) == count(body_on(backend, coarse())));
  });
}

TEST_CASE("a mesh holds a budget while what it resolves wanders, and spends it well",
          "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_on(backend, coarse());
    double const budget = 1000;
    auto adapt = Adaptation{
        within<Held<Tri3>>(RecoveredStress{}, {.evaluations_per_step = budget, .max_level = 5})};
    for (double place : {1.0, 1.3, 1.6, 2.0, 2.5, 3.0}) {
      look(body, adapt, place);
      CHECK(count(body) > 0.9 * budget);
      CHECK(count(body) < 1.1 * budget);
      auto const mesh = mesh::rectangle<Tri3>({.size = {4, 1}, .cells = {46, 11}});  // as many
      auto uniform = body_on(backend, mesh);
      bump(uniform, place);
      CHECK(estimate(body, RecoveredStress{}) < 0.25 * estimate(uniform, RecoveredStress{}));
    }
  });
}

TEST_CASE("a budget goes to other elements where some are as fine as they may be", "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_on(backend, coarse());
    double const budget = 0.8 * 4 * count(body);
    auto adapt = Adaptation{
        within<Held<Tri3>>(RecoveredStress{}, {.evaluations_per_step = budget, .max_level = 1})};
    look(body, adapt, 2);
    CHECK(count(body) > 0.95 * budget);
    CHECK(count(body) < 1.05 * budget);
  });
}

TEST_CASE("of an error and a budget the budget comes first", "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_on(backend, coarse());
    auto adapt = Adaptation{within<Held<Tri3>>(
        RecoveredStress{}, {.error = 1e-12, .evaluations_per_step = 600, .max_level = 3})};
    look(body, adapt, 2);
    CHECK(count(body) < 660);
    CHECK(std::ranges::max(refinement_levels<Tri3>(body)) <= 3);
  });
}

TEST_CASE("a body that swings holds its mesh between steps", "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_on(backend, coarse());
    bump(body, 2);
    double const error = estimate(body, RecoveredStress{}) / 10;
    auto adapt =
        Adaptation{within<Held<Tri3>>(RecoveredStress{}, {.error = error, .max_level = 2})}.every(
            16);
    CentralDifference step;
    step(body, 160, adapt);
    CHECK(estimate(body, RecoveredStress{}) < 2 * error);
  });
}

using Held4 = Formulation<Quad4, Gauss<2>, Hooke>;
using Held9 = Formulation<Quad9, Gauss<3>, Hooke>;

/// Both degrees, all elements linear.
template <class B>
auto body_of_degrees(B const& backend, int across = 16) {
  auto const quads = mesh::rectangle({.size = {4, 1}, .cells = {across, across / 4}});
  Mesh<Quad4, Quad9> mesh{quads.nodes, {}};
  mesh.elements<Quad4>() = quads.template elements<Quad4>();
  return Body{backend, mesh, soft, Group<Held4>{}, Group<Held9>{}};
}
template <class E, class TheBody>
double count_of(TheBody const& body) {
  return static_cast<double>(body.mesh().template elements<E>().size());
}

TEST_CASE("a mesh raises degrees where that is worth more, and lowers them behind",
          "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_of_degrees(backend);
    bump(body, 1);
    double const error = estimate(body, RecoveredStress{}) / 300;
    auto adapt =
        Adaptation{within<Held4, Held9>(RecoveredStress{}, {.error = error, .max_level = 4})};
    auto refining = body_of_degrees(backend);
    auto refine_alone =
        Adaptation{within<Held4>(RecoveredStress{}, {.error = error, .max_level = 4})};
    auto const evaluations = [](auto const& of) {
      return evaluations_per_step(of, within<Held4, Held9>(RecoveredStress{}, {.error = 1}));
    };
    for (double place : {1.0, 1.5, 2.5}) {
      look(body, adapt, place);
      look(refining, refine_alone, place);
      CHECK(estimate(body, RecoveredStress{}) < 1.2 * error);
      CHECK(count_of<Quad9>(body) > 10);
      CHECK(count_of<Quad4>(body) > 10);
      // A smooth bump wants fewer evaluations of the higher degree.
      CHECK(evaluations(body) < 0.7 * evaluations(refining));
    }
    look(body, adapt, 1, 0);
    CHECK(count_of<Quad9>(body) == 0);
    CHECK(count_of<Quad4>(body) == 64);
  });
}

TEST_CASE("far from the error that is asked for nothing is undone", "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_of_degrees(backend);
    auto const rule = within<Held4, Held9>(RecoveredStress{}, {.error = 1e-14, .max_level = 4});
    auto adapt = Adaptation{rule};
    // A slope everywhere; then a corner too where the gradient has no limit, beside which that is worth little at first.
    auto const bend = [&](double corner) {
      auto u = body.mesh().nodes;
      for (auto& p : u)
        p = {corner * std::pow(std::hypot(p[0], p[1]), 0.3) + 1e-4 * std::sin(3 * p[0]), 0};
      body.set_displacements(u);
    };
    double evaluations = 0;
    for (int k = 0; k < 8; ++k) {
      bend(k < 3 ? 0 : 0.01);
      adapt.now(body);
      double const now = evaluations_per_step(body, rule);
      CHECK(now >= evaluations);
      evaluations = now;
    }
  });
}

TEST_CASE("a budget holds for both degrees", "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_of_degrees(backend);
    double const budget = 1500;
    auto const rule =
        within<Held4, Held9>(RecoveredStress{}, {.evaluations_per_step = budget, .max_level = 5});
    auto adapt = Adaptation{rule};
    for (double place : {1.0, 1.3, 2.0, 3.0}) {
      look(body, adapt, place);
      double const now = evaluations_per_step(body, rule);
      CHECK(now > 0.85 * budget);
      CHECK(now < 1.1 * budget);
    }
  });
}

inline double seconds_shown = 0;

TEST_CASE("a budget in milliseconds asks the clock what an element takes", "[adaptation]") {
  on_each_backend<FewBackends>([](auto const& backend) {
    auto body = body_on(backend, coarse());
    seconds_shown = 0;
    double per_element = 1e-6;
    auto adapt =
        Adaptation{within<Held<Tri3>>(RecoveredStress{}, {.milliseconds_per_step = 1,
                                                          .clock = [] { return seconds_shown; }})}
            .every(4);
    CentralDifference step;
    auto const run = [&] {
      for (int k = 0; k < 80; ++k) {
        bump(body, 2);
        step(body);
        seconds_shown += per_element * count(body);
        adapt(body);
      }
    };

    run();
    CHECK(count(body) > 900);
    CHECK(count(body) < 1100);
    per_element = 2e-6;
    run();
    CHECK(count(body) > 450);
    CHECK(count(body) < 550);
  });
}

TEST_CASE("families of which an element sleeps stay as they are", "[adaptation]") {
  SmallPatches<double, 3> const backend;  // which tear families apart
  auto body = body_on(backend, mesh::rectangle<Tri3>({.size = {8, 1}, .cells = {32, 4}}));
  std::vector<Index> all(static_cast<std::size_t>(count(body)));
  for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
  refine(body, {all});
  // The far end rests.
  auto v = body.mesh().nodes;
  for (auto& p : v) p = {0, p[0] < 2 ? 1.0 : 0.0};
  body.set_velocities(v);
  CentralDifference steps({.step = 1e-3 * stable_step(body)});
  auto rest = Adaptation{sleep({.below = 1e-6, .for_steps = 1})}.every(1);
  steps(body, 4, rest);
  auto const asleep = asleep_elements<Tri3>(body);
  double kept = 0, torn = 0;  // families
  for (std::size_t e = 0; e < asleep.size(); e += 4) {
    auto const sleepers = asleep[e] + asleep[e + 1] + asleep[e + 2] + asleep[e + 3];
    kept += sleepers > 0 ? 1 : 0;
    torn += sleepers > 0 && sleepers < 4 ? 1 : 0;
  }
  CHECK(torn > 0);
  Adaptation{within<Held<Tri3>>(RecoveredStress{}, {.error = 1e9})}.now(body);
  auto const levels = refinement_levels<Tri3>(body);
  CHECK(static_cast<double>(std::ranges::count(levels, 1)) == 4 * kept);
  CHECK(std::ranges::count(levels, 0) > 0);
}

TEST_CASE("limits of a mesh are in range", "[adaptation]") {
  auto const makes = [](MeshWithinOptions const& options) {
    (void)within<Held<Tri3>>(RecoveredStress{}, options);
  };
  CHECK_THROWS_WITH(makes({}), says("no limit"));
  CHECK_THROWS_WITH(makes({.error = 0}), says("a positive number"));
  CHECK_THROWS_WITH(makes({.error = 1, .release = 2}), says("release"));
  CHECK_THROWS_WITH(makes({.error = 1, .max_level = -1}), says("max_level"));
  CHECK_THROWS_WITH(makes({.error = 1, .max_level = most_levels + 1}), says("at most 63"));
  CHECK_THROWS_WITH(makes({.milliseconds_per_step = -1}), says("a positive number"));
}

}  // namespace pliant::test::mesh_within_suite
