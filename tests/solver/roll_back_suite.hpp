#pragma once

#include <stdexcept>

#include "support/formulations.hpp"
#include "support/repeatable.hpp"

// A roll-back brings back all that a run changes, and says what it did.
namespace pliant::test {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Turning = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
inline constexpr Elastic gel{1e5, 0.3, 1e3};

template <class B>
auto gel_beam(B const& backend) {
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {16, 4}});
  Body body{backend, mesh, gel, Group<Linear>{}, Group<Turning>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -9.81});
  return body;
}

TEST_CASE("roll-back keeps the books of adaptation", "[solver]") {
  on_each_backend<std::tuple<MainBackend>>([]<class B>(B const& backend) {
    int retries = 0;
    for (double fraction : {1.5, 2.0, 3.0, 4.0, 6.0}) {
      CAPTURE(fraction);
      auto body = gel_beam(backend);
      auto const deformed = largest(EdgeLengthRatio{}, AreaRatio{}, Rotation{});
      Adaptation adapt{when<Linear>(deformed).above(0.10).template become<Turning>(),
                       when<Turning>(deformed).below(0.05).template become<Linear>()};
      CentralDifference step{{.step = fraction * stable_step(body)}};
      try {
        for (int k = 0; k < 1000; ++k) {
          step(body);
          adapt(body);
        }
      } catch (Error const&) {
        // Books must be right then too.
      }
      retries += step.retries();
      auto const spent = element_steps<Quad4>(body);
      CHECK(spent[0] >= 0);
      CHECK(spent[1] >= 0);
      CHECK(spent[0] + spent[1] == 64.0 * static_cast<double>(body.steps()));
      CHECK(std::isfinite(adaptation_energy(body)));
      // One that counted a run thrown away would have more than the body.
      CHECK(std::abs(adaptation_energy(body)) < 2 * strain_energy(body) + 100);
      double moved = 0, counted = 0;
      for (auto const& entry : ledger(body)) moved += entry.elements;
      for (int n : switch_counts<Quad4>(body)) counted += n;
      CHECK(moved == counted);
    }
    CHECK(retries > 0);
  });
}

TEST_CASE("roll-back brings back every member of a state", "[solver]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    using Slow = Formulation<Quad4, Gauss<2>, KelvinVoigt<NeoHookean>::law>;
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {4, 2}});
    Body body{backend, mesh, gel, Group<Slow>{{KelvinVoigt<NeoHookean>::law<double>{}}}};
    (void)body;
  });
}

}  // namespace pliant::test
