#include "support/difference_quotient.hpp"
#include "support/laws.hpp"

namespace pliant::test::derivatives_test {

TEST_CASE("stress is the derivative of the energy", "[law]") {
  on_each_law<Ask::energy_and_stress>([](auto law, auto dim) {
    constexpr int n = dim();
    Random random(7);
    for (int state = 0; state < 20; ++state) {
      auto const h = random_state<n>(random);
      auto const p = stress(law, h);
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          auto const slope = derivative(
              [&](double t) {
                auto moved = h;
                moved(i, j) += t;
                return energy_density(law, moved);
              },
              2e-3);
          CHECK(p(i, j) == Approx(slope).epsilon(0).margin(1e-8 * (largest<n>(p) + 1)));
        }
    }
  });
}

TEST_CASE("all laws are Hooke's at small strain", "[law]") {
  on_each_law<Ask::energy_and_stress>([](auto law, auto dim) {
    if (!law.kind.like_hooke) return;
    constexpr int n = dim();
    Random random(10);
    auto const hooke = law_of_section_6<Hooke>;
    for (int state = 0; state < 20; ++state) {
      auto const direction = random.tensor<n>(1);
      for (double strain : {1e-3, 1e-5, 1e-7}) {
        auto const h = strain * direction;
        // They part at second order, with moduli of second order below 10 times the first.
        CHECK(largest<n>(stress(law, h) - stress(hooke, h)) < 100 * strain * strain);
        CHECK(largest<n>(stress(hooke, h)) > 0.1 * strain);
        CHECK(std::abs(energy_density(law, h) - energy_density(hooke, h)) <
              100 * strain * strain * strain);
      }
    }
  });
}

}  // namespace pliant::test::derivatives_test
