#include <pliant/backend/value_at.hpp>

#include "support/catch.hpp"

namespace pliant::test {

TEST_CASE("what is not finite counts as infinite in a maximum, and as nothing in a sum",
          "[backend]") {
  double const infinity = std::numeric_limits<double>::infinity();
  double const largest = std::numeric_limits<double>::max();
  double const not_finite[] = {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()};
  for (double x : not_finite) {
    CHECK(detail::infinite_if_not_finite(x) == infinity);
    CHECK(detail::zero_if_not_finite(x) == 0);
  }
  for (double x : {0.0, -1.5, largest, -largest}) {
    CHECK(detail::infinite_if_not_finite(x) == x);
    CHECK(detail::zero_if_not_finite(x) == x);
  }
}

}  // namespace pliant::test
