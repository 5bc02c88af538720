#pragma once

#include "adaptation/criteria.hpp"

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
    auto adapt =
        Adaptation{within<Held<Tri3>>(RecoveredStress{}, {.evaluations_per_step = budget})};
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

TEST_CASE("limits of a mesh are in range", "[adaptation]") {
  auto const makes = [](MeshWithinOptions const& options) {
    (void)within<Held<Tri3>>(RecoveredStress{}, options);
  };
  CHECK_THROWS_WITH(makes({}), says("no limit"));
  CHECK_THROWS_WITH(makes({.error = 0}), says("a positive number"));
  CHECK_THROWS_WITH(makes({.error = 1, .release = 2}), says("release"));
  CHECK_THROWS_WITH(makes({.error = 1, .max_level = -1}), says("max_level"));
}

}  // namespace pliant::test::mesh_within_suite
