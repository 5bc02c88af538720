#pragma once

#include "support/seed_scene.hpp"

namespace pliant::test::energy_suite {

/// The largest |E| up to 0.4 s from rest, where E is 0.
template <class B>
double energy_error(B const& backend, double dt) {
  auto body = seed_body<Formulation<Quad4, Gauss<2>, NeoHookean>>(backend);
  CentralDifference step{{.step = dt}};
  double error = 0;
  int const steps = static_cast<int>(std::lround(0.4 / dt));
  for (int k = 0; k < steps; ++k) {
    step(body);
    error = std::max(error, std::abs(total_energy(body)));
  }
  return error;
}

TEST_CASE("the energy error of central differences is of second order", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    double const coarse = energy_error(backend, 8e-4), middle = energy_error(backend, 4e-4),
                 fine = energy_error(backend, 2e-4);

    CHECK(coarse == Approx(8.456e-4).epsilon(0.01));  // REFERENCES, section 11
    CHECK(middle == Approx(2.113e-4).epsilon(0.01));
    CHECK(fine == Approx(5.287e-5).epsilon(0.01));
    CHECK(coarse / middle == Approx(4).epsilon(0.02));
    CHECK(middle / fine == Approx(4).epsilon(0.02));
  });
}

}  // namespace pliant::test::energy_suite
