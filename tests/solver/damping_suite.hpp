#pragma once

#include "support/assembly.hpp"
#include "support/formulations.hpp"

namespace pliant::test {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;

TEST_CASE("damping slows a free body down at its rate", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto body = body_of<Linear>(backend, distorted_mesh<Quad4>(4));
    double const damping = 3, dt = 0.05;
    body.set_damping(damping);
    body.set_velocities(FieldOf<2>(static_cast<std::size_t>(body.nodes()), {2, -1}));
    CentralDifference step{{.step = dt}};

    step(body, 20);

    // Centred: (v⁺ − v⁻)/dt = −damping (v⁺ + v⁻)/2.
    double const decay = std::pow((1 - damping * dt / 2) / (1 + damping * dt / 2), 20);
    double const epsilon = 64 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    for (auto const& v : body.velocities()) {
      CHECK(v[0] == Approx(2 * decay).epsilon(epsilon));
      CHECK(v[1] == Approx(-decay).epsilon(epsilon));
    }
  });
}

/// The displacements that random ones of 1 mm have grown to after 400 steps of `fraction` of the
/// stable limit.
template <class B>
double growth(B const& backend, double damping, double fraction) {
  auto const mesh = distorted_mesh<Quad4>(4);
  auto body = body_of<Linear>(backend, mesh);
  FieldOf<2> const rest(mesh.nodes.size());
  double const largest_square =
      squared_frequencies(body, rest, [](std::size_t, std::size_t) { return true; }).maxCoeff();
  body.set_damping(damping * std::sqrt(largest_square));
  body.set_displacements(Random(1).field<2>(mesh.nodes.size(), 1e-3));
  double const dt = fraction * 2 / std::sqrt(largest_square);
  int const checks = 1 << 30;  // none: an unstable step must show
  CentralDifference step{{.step = dt, .check_interval = checks}};
  step(body, 400);
  return largest(body.displacements()) / 1e-3;
}

TEST_CASE("mass damping leaves the stable limit where it is", "[solver]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    for (double damping : {0.0, 0.02, 0.5, 2.0}) {
      INFO("damping over the highest frequency: " << damping);
      CHECK(growth(backend, damping, 0.999) < 100);
      CHECK(growth(backend, damping, 1.05) > (damping < 1 ? 1e3 : 10));
    }
  });
}

}  // namespace pliant::test
