#include "support/difference_quotient.hpp"
#include "support/laws.hpp"

namespace pliant::test::tangents_test {

TEST_CASE("the tangent is the derivative of the stress", "[law]") {
  on_each_law<Ask::stress_and_tangent>([](auto law, auto dim) {
    constexpr int n = dim();
    Random random(8);
    for (int state = 0; state < 20; ++state) {
      auto const h = random_state<n>(random), along = random.tensor<n>(1);
      auto const dp = stress_tangent_product(law, h, along);
      auto const slope =
          tensor_derivative<n>([&](double t) { return stress(law, h + t * along); }, 2e-3);
      CHECK(largest<n>(dp) > 0.1);
      CHECK(largest<n>(dp - slope) < 1e-8 * largest<n>(dp));
    }
  });
}

TEST_CASE("the tangent is symmetric at every point", "[law]") {
  on_each_law<Ask::stress_and_tangent>([](auto law, auto dim) {
    constexpr int n = dim();
    Random random(9);
    for (int state = 0; state < 20; ++state) {
      auto const h = random_state<n>(random), a = random.tensor<n>(1), b = random.tensor<n>(1);
      CHECK(dot(a, stress_tangent_product(law, h, b)) ==
            Approx(dot(b, stress_tangent_product(law, h, a))).epsilon(0).margin(1e-13));
    }
  });
}

}  // namespace pliant::test::tangents_test
