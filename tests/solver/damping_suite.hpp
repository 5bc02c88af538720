#pragma once

#include "support/assembly.hpp"
#include "support/formulations.hpp"

namespace pliant::test::damping_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;

TEST_CASE("damping slows a free body down at its rate, however strong it is", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    for (double per_step : {0.1, 1.0, 1.9, 2.5, 10.0, 100.0}) {
      CAPTURE(per_step);
      auto body = body_of<Linear>(backend, distorted_mesh<Quad4>(4));
      double const dt = 0.05, damping = per_step / dt;
      body.set_damping(damping);
      body.set_velocities(FieldOf<2>(static_cast<std::size_t>(body.nodes()), {2, -1}));
      CentralDifference step{{.step = dt}};
      double const epsilon = 64 * double{std::numeric_limits<typename B::scalar>::epsilon()};

      for (int k = 1; k <= 5; ++k) {
        step(body);
        double const decay = std::exp(-per_step * k);
        if (decay < 1e-30) continue;  // in single precision
        for (auto const& v : body.velocities()) {
          CHECK(v[0] == Approx(2 * decay).epsilon(epsilon * per_step * k).margin(1e-18));
          CHECK(v[1] == Approx(-decay).epsilon(epsilon * per_step * k).margin(1e-18));
        }
      }
    }
  });
}

TEST_CASE("damping takes energy and gives none, however strong it is", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Quad4>(4);
    for (double per_step : {0.1, 1.0, 2.5, 10.0, 100.0}) {
      CAPTURE(per_step);
      auto body = body_of<Linear>(backend, mesh);
      double const dt = 0.9 * stable_step(body);
      body.set_damping(per_step / dt);
      body.set_displacements(Random(1).field<2>(mesh.nodes.size(), 1e-3));
      CentralDifference step{{.step = dt}};
      step(body);
      double last = leapfrog_energy(body.parts()).kept();
      double const first = last;
      bool grew = false;
      for (int k = 0; k < 100; ++k) {
        step(body);
        double const kept = leapfrog_energy(body.parts()).kept();
        grew = grew || kept > last + 1e-13 * first;
        last = kept;
      }
      CHECK_FALSE(grew);
      CHECK(last < 0.9 * first);
      CHECK(external_work(body).damping < 0);
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
  CentralDifference step{
      {.step = dt, .check_interval = checks, .energy_growth = 1e9, .energy_drift = 1e9}};
  step(body, 400);
  return largest(body.displacements()) / 1e-3;
}

TEST_CASE("mass damping does not lower the stable limit", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    for (double damping : {0.0, 0.02, 0.5, 2.0}) {
      INFO("damping over the highest frequency: " << damping);
      CHECK(growth(backend, damping, 0.999) < 100);
      // Strong damping raises it, to tanh(c Δt/2)/(c Δt/2) ω² Δt² = 4.
      if (damping < 0.1) CHECK(growth(backend, damping, 1.05) > 1e3);
    }
  });
}

}  // namespace pliant::test::damping_suite
