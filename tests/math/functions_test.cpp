#include <pliant/math/functions.hpp>

#include "support/catch.hpp"

namespace pliant::test::functions_test {

/// x − ln(1 + x) in extended precision, by its series where the difference would cancel.
long double exact_excess(long double x) {
  if (std::fabs(x) > 0.1L) return x - std::log1p(x);
  long double sum = 0, power = x * x;
  for (int k = 2; k < 60; ++k, power *= -x) sum += power / k;
  return sum;
}

TEMPLATE_TEST_CASE("x - ln(1 + x) keeps its digits near zero", "[math]", float, double) {
  double const epsilon = double{std::numeric_limits<TestType>::epsilon()};
  for (double size : {1e-12, 1e-8, 1e-4, 0.01, 0.0624, 0.0626, 0.3, 0.9, 3.0, 50.0})
    for (double sign : {1.0, -1.0}) {
      if (sign * size <= -1) continue;
      auto const x = static_cast<TestType>(sign * size);
      auto const exact = static_cast<double>(exact_excess(static_cast<long double>(x)));
      INFO("x = " << x);
      // The difference x − log1p(x) may lose the 6 bits by which it is smaller than x.
      double const units = size < 0.0625 ? 8 : 64;
      CHECK(static_cast<double>(excess_of_log1p(x)) == Approx(exact).epsilon(units * epsilon));
    }
  CHECK(excess_of_log1p(TestType(0)) == 0);
}

/// eˣ − 1 − x in extended precision.
long double exact_excess_of_exponential(long double x) {
  if (std::fabs(x) > 0.1L) return std::expm1(x) - x;
  long double sum = 0, term = x * x / 2;
  for (int k = 3; k < 40; ++k, term *= x / (k - 1)) sum += term;
  return sum;
}

TEMPLATE_TEST_CASE("exp(x) - 1 - x keeps its digits near zero", "[math]", float, double) {
  double const epsilon = double{std::numeric_limits<TestType>::epsilon()};
  for (double size : {1e-12, 1e-8, 1e-4, 0.01, 0.3, 0.499, 0.501, 3.0, 50.0})
    for (double sign : {1.0, -1.0}) {
      auto const x = static_cast<TestType>(sign * size);
      auto const exact = exact_excess_of_exponential(static_cast<long double>(x));
      INFO("x = " << x);
      CHECK(static_cast<double>(excess_of_expm1(x)) ==
            Approx(static_cast<double>(exact)).epsilon(8 * epsilon));
    }
  CHECK(excess_of_expm1(TestType(0)) == 0);
}

TEST_CASE("select, min and max choose", "[math]") {
  CHECK(select(true, 1.0, 2.0) == 1);
  CHECK(select(false, 1.0, 2.0) == 2);
  CHECK(pliant::max(1.0, 2.0) == 2);
  CHECK(pliant::max(2.0, 1.0) == 2);
  CHECK(pliant::min(1.0, 2.0) == 1);
  CHECK(pliant::min(2.0, 1.0) == 1);
  CHECK(square(-3.0) == 9);
  CHECK(square_of_positive(3.0) == 9);
  CHECK(square_of_positive(-3.0) == 0);
}

}  // namespace pliant::test::functions_test
