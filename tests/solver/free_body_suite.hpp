#pragma once

#include "support/formulations.hpp"

namespace pliant::test::free_body_suite {

template <class TheBody>
FieldOf<TheBody::dim> momenta(TheBody& body) {
  auto p = body.velocities();
  for (std::size_t i = 0; i < p.size(); ++i)
    for (double& x : p[i]) x *= body.parts().layout.mass_list()[i];
  return p;
}

TEST_CASE("a free body keeps its linear and angular momentum", "[solver]") {
  on_few_formulations<AllBackends>([]<class B, class F>(Case<B, F>) {
    using T = typename B::scalar;
    // Hooke's law makes moments when a body turns, and keeps only linear momentum.
    constexpr bool turns = !std::same_as<typename F::template law<double>, Hooke<double>>;
    int const n = F::dim == 2 ? 6 : 3;
    auto const mesh = distorted_mesh<typename F::element>(n);
    auto body = body_of<F>(B{}, mesh);
    auto v = Random(1).field<F::dim>(mesh.nodes.size(), 0.2);
    for (std::size_t i = 0; i < v.size(); ++i) {  // and a spin
      v[i][0] -= 2 * mesh.nodes[i][1];
      v[i][1] += 2 * mesh.nodes[i][0] + 1;
    }
    body.set_velocities(v);
    auto const positions = [&] { return plus(mesh.nodes, 1, body.displacements()); };
    auto const p0 = total(momenta(body));
    auto const l0 = moment(positions(), momenta(body));
    int const steps = 200;
    CentralDifference step{};

    step(body, steps);

    // Forces are rounded in each step: at random, so that errors add up as a square root.
    double const rounding = 32 * double{std::numeric_limits<T>::epsilon()} * std::sqrt(steps);
    auto const p = total(momenta(body));
    auto const l = moment(positions(), momenta(body));
    for (std::size_t k = 0; k < p.size(); ++k) CHECK(std::abs(p[k] - p0[k]) < rounding);
    if (turns)
      for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(l[k] - l0[k]) < rounding * 4);
    CHECK(largest(body.displacements()) > 0.1);
    CHECK(strain_energy(body) > 1e-4);
  });
}

}  // namespace pliant::test::free_body_suite
