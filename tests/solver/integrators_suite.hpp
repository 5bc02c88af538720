#pragma once

#include <optional>

#include "support/formulations.hpp"

namespace pliant::test::integrators_suite {

TEST_CASE("an integrator made where another one was in memory takes its own steps", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body =
        body_of<Formulation<Quad4, Gauss<2>, NeoHookean>>(backend, distorted_mesh<Quad4>(4));
    body.set_gravity({0, -1});
    std::optional<CentralDifference> step;
    for (double size : {1e-3, 2e-3}) {
      step.emplace(CentralDifferenceOptions{.step = size});
      CHECK((*step)(body, 10).step == size);
    }
  });
}

}  // namespace pliant::test::integrators_suite
