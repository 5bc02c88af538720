#pragma once

#include <pliant/body/compare.hpp>

#include "adaptation/plane_bodies.hpp"
#include "support/repeatable.hpp"

// Steps that an integrator takes together with the looks of an adaptation between them.
namespace pliant::test::recorded_looks_suite {

inline constexpr double switch_at = 0.01;

/// Leaves the linear law where it is stretched, and comes back a while after; with a budget, so that values
/// are ranked, or without.
inline auto stretched(bool ranked) {
  auto leave = when<QuadLinear>(EdgeLengthRatio{}).above(switch_at);
  auto back = when<QuadRubber>(EdgeLengthRatio{}).below(0.8 * switch_at).stay(40);
  if (ranked) {
    leave = leave.budget(5);
    back = back.budget(7);
  }
  return Adaptation{leave.template become<QuadRubber>(), back.template become<QuadLinear>()};
}

/// A body that swings under its load.
template <class B>
auto swinging(B const& backend) {
  auto const mesh = mesh::rectangle<Quad4>({.size = {4, 1}, .cells = {8, 2}});
  Body body{backend, mesh, Elastic{.young = 1000, .poisson = 0.3, .density = 10},
            Group<QuadLinear>{}, Group<QuadRubber>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -0.3});
  return body;
}

template <class TheBody>
double moves(TheBody const& body) {
  double sum = 0;
  for (auto const& entry : ledger(body)) sum += entry.elements;
  return sum;
}

TEST_CASE("steps with looks between them are those of a loop that looks after each step",
          "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    bool const exact = sizeof(typename B::scalar) == 8;
    for (bool ranked : {false, true})
      for (int interval : {1, 8, 13}) {
        INFO("ranked " << ranked << ", every " << interval << " steps");
        auto looped = swinging(backend), together = swinging(backend);
        CentralDifference one{{.safety = 0.5}}, other{{.safety = 0.5}};
        auto look = stretched(ranked).every(interval), again = stretched(ranked).every(interval);
        std::int64_t steps = 0;
        for (int n : {3, 64, 1, 300, 7, 225}) {
          for (int k = 0; k < n; ++k) {
            one(looped);
            look(looped);
          }
          auto const advanced = other(together, n, again);
          steps += n;
          CHECK(advanced.steps == n);
          REQUIRE(together.steps() == steps);
        }
        REQUIRE(moves(looped) > 10);
        REQUIRE(one.retries() + other.retries() == 0);
        if (between_runs(1) == 0) {
          CHECK(first_difference(looped.state(), together.state()) == "");
        } else {
          CHECK(difference(together.displacements(), looped.displacements()) <
                (exact ? 1e-8 : 1e-2) * largest(looped.displacements()));
          if (!exact) continue;  // an element at a threshold may go either way
          CHECK(moves(together) == moves(looped));
          CHECK(together.template groups_of<Quad4>() == looped.template groups_of<Quad4>());
          CHECK(element_steps<Quad4>(together) == element_steps<Quad4>(looped));
          CHECK(std::abs(adaptation_energy(together) - adaptation_energy(looped)) < 1e-8);
        }
      }
  });
}

TEST_CASE("an adaptation that refines looks between an integrator's steps too", "[adaptation]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto looped = swinging(backend), together = swinging(backend);
    CentralDifference one, other;
    auto const refining = [] {
      return Adaptation{
          when<QuadLinear>(EdgeLengthRatio{}).above(switch_at).refine({.max_level = 1})};
    };
    auto look = refining().every(8), again = refining().every(8);
    for (int k = 0; k < 200; ++k) {
      one(looped);
      look(looped);
    }
    other(together, 200, again);
    REQUIRE(looped.mesh().nodes.size() > swinging(backend).mesh().nodes.size());
    CHECK(together.mesh().nodes.size() == looped.mesh().nodes.size());
    CHECK(together.steps() == looped.steps());
  });
}

}  // namespace pliant::test::recorded_looks_suite
