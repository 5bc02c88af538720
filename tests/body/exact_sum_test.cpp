#include <limits>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/body/exact_sum.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"

// Sums of masses have no rounding, and are read with one.
namespace pliant::test::exact_sum_test {

using pliant::detail::ExactSum;
using pliant::detail::SumUnit;

/// Numbers below one, of which the smallest are 2⁻⁷⁰.
std::vector<double> numbers(std::size_t count) {
  Random random;
  std::vector<double> list(count);
  for (double& x : list)
    x = std::ldexp(std::abs(random()), -static_cast<int>(random.below(18))) + std::ldexp(1.0, -70);
  return list;
}

TEST_CASE("exact sums do not depend on the order, and end at zero", "[body]") {
  SumUnit const unit(1 << 20);
  auto list = numbers(1000);
  auto const sum_of = [&] {
    ExactSum sum;
    for (double const x : list) sum += unit.multiple_of(x);
    return sum;
  };
  auto sum = sum_of();
  for (int k = 0; k < 5; ++k) {
    Random(static_cast<unsigned>(k)).shuffle(list);
    CHECK(sum_of() == sum);
  }
  CHECK(unit.value_of(sum) > 10);
  Random(7).shuffle(list);
  ExactSum below;  // it is negative on the way
  for (double const x : list) below += -unit.multiple_of(x);
  CHECK(below == -sum);
  below += sum;
  CHECK(below == ExactSum{});
  CHECK(unit.value_of(below) == 0);
}

TEST_CASE("threads that add to exact sums lose nothing", "[body]") {
  SumUnit const unit(1 << 20);
  auto const list = numbers(40'000);
  std::vector<ExactSum> sums(3), at_once(3);
  for (std::size_t i = 0; i < list.size(); ++i) sums[i % 3] += unit.multiple_of(list[i]);
  HostThreads const threads(4);
  detail::for_each_on_host(static_cast<Index>(list.size()), 1000, [&](Index k) {
    auto const i = static_cast<std::size_t>(k);
    at_once[i % 3].add_from_threads(unit.multiple_of(list[i]));
  });
  CHECK(at_once == sums);
}

TEST_CASE("an exact sum is read as the nearest number", "[body]") {
  SumUnit const unit(8);
  auto const sum_of = [&](std::vector<double> const& list) {
    ExactSum sum;
    for (double const x : list) sum += unit.multiple_of(x);
    return unit.value_of(sum);
  };
  double const last = std::numeric_limits<double>::epsilon();
  CHECK(sum_of({1, last / 2}) == 1);
  CHECK(sum_of({1, last / 2, 0x1p-115}) == 1 + last);
  CHECK(sum_of({1, last, last / 2}) == 1 + 2 * last);
  CHECK(sum_of({1, last / 4, last / 4, last / 4}) == 1 + last);
  CHECK(sum_of({0x1p-60, 0x1p-112}) == 0x1p-60 + 0x1p-112);
  CHECK(sum_of({0x1p-61, 0x1p-62, 0x1p-115}) == 0x1p-61 + 0x1p-62);
  for (double const x : numbers(100)) CHECK(sum_of({x}) == x);
}

TEST_CASE("units of sums suit numbers of all sizes", "[body]") {
  double const largest = std::numeric_limits<double>::max(),
               none = std::numeric_limits<double>::quiet_NaN(),
               infinite = std::numeric_limits<double>::infinity();
  for (double const most : {1e-250, 1e-30, 1.0, 3.0, 1e300, largest, infinite}) {
    SumUnit const unit(most);
    double const x = std::min(most, largest) / 3, tiny = x * 0x1p-200;
    CHECK(unit.holds(x));
    CHECK(unit.value_of(unit.multiple_of(x)) == x);
    CHECK(unit.holds(0));
    CHECK(unit.multiple_of(0) == ExactSum{});
    CHECK(unit.value_of(unit.multiple_of(tiny)) > 0);
    CHECK(unit.value_of(unit.multiple_of(tiny)) < x * 0x1p-120);
    if (most < 1e300) CHECK_FALSE(unit.holds(2 * most));
    for (double const wrong : {-x, none, infinite}) CHECK_FALSE(unit.holds(wrong));
  }
  for (double const most : {0.0, none}) CHECK(SumUnit(most).holds(1e-290));
}

}  // namespace pliant::test::exact_sum_test
