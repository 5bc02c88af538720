#include <pliant/math/dual.hpp>

#include "support/catch.hpp"
#include "support/difference_quotient.hpp"

namespace pliant::test::dual_test {

/// A function of two numbers, for any scalar, that uses all operators and elementary functions.
struct Everything {
  template <class S>
  S operator()(S const& x, S const& y) const {
    S z = 2 * x - y / 3 + x * y / (1 + y * y) - 0.5;
    z += sqrt(2 + x * x) * exp(-y) + 1 / (3 - x);
    z -= log(2 + square(x)) * log1p(y * y);
    z *= abs(x - 2) + max(x, y) + min(x * x, 3 - y) + select(x < y, x, x * y);
    z += expm1(x - y) * cbrt(x - 2) + excess_of_expm1(x * y / 4) + excess_of_expm1(1 + y);
    z += square_of_positive(x - y) - square_of_positive(y / 2 - x);
    return -z + excess_of_log1p(x * y / 4) + excess_of_log1p(x / 100) + (x < 100 ? 1 - x : x);
  }
};

TEST_CASE("duals carry the values and the derivatives along", "[math]") {
  using D = Dual<double, 2>;
  for (auto const& point : {std::pair{0.3, 0.8}, {0.9, 0.2}, {-0.6, 0.7}, {1.7, 1.1}}) {
    double const x = point.first, y = point.second;
    D const z = Everything{}(D::variable(x, 0), D::variable(y, 1));

    CHECK(z.value == Approx(Everything{}(x, y)).epsilon(1e-14));
    CHECK(z.derivative[0] ==
          Approx(derivative([&](double h) { return Everything{}(x + h, y); }, 1e-3)).epsilon(1e-9));
    CHECK(z.derivative[1] ==
          Approx(derivative([&](double h) { return Everything{}(x, y + h); }, 1e-3)).epsilon(1e-9));
  }
}

TEST_CASE("duals of duals carry second derivatives", "[math]") {
  using D = Dual<double, 1>;
  using DD = Dual<D, 1>;
  double const x = 0.4, y = 0.7;
  DD along_x(D::variable(x, 0)), constant(D{y});
  along_x.derivative[0] = D(1.0);

  DD const z = Everything{}(along_x, constant);

  auto const slope = [&](double h) {
    return Everything{}(D::variable(x + h, 0), D(y)).derivative[0];
  };
  CHECK(z.value.value == Approx(Everything{}(x, y)).epsilon(1e-14));
  CHECK(z.value.derivative[0] == Approx(slope(0)).epsilon(1e-13));
  CHECK(z.derivative[0].value == Approx(slope(0)).epsilon(1e-13));
  CHECK(z.derivative[0].derivative[0] == Approx(derivative(slope, 1e-3)).epsilon(1e-9));
}

TEST_CASE("duals that know their zeros have the derivatives of those that do not", "[math]") {
  using Knowing = Dual<double, 2, Zeros::known>;
  using Plain = Dual<double, 2>;
  for (auto const& point : {std::pair{0.3, 0.8}, {0.9, 0.2}, {-0.6, 0.7}, {1.7, 1.1}}) {
    double const x = point.first, y = point.second;
    Knowing const along_x = Knowing::variable(x, 0), along_y = Knowing::variable(y, 1);
    Plain const z = Everything{}(Plain::variable(x, 0), Plain::variable(y, 1));
    Plain const by_x = Everything{}(Plain::variable(x, 0), Plain(y));

    auto const compare = [](Knowing const& a, Plain const& b) {
      CHECK(a.value == Approx(b.value).epsilon(1e-14));
      for (int k = 0; k < 2; ++k) CHECK(a.derivative[k] == Approx(b.derivative[k]).epsilon(1e-13));
    };
    compare(Everything{}(along_x, along_y), z);
    compare(Everything{}(along_x, Knowing(y)), by_x);
    compare(Knowing(Everything{}(along_x, along_y) * by_x), z * by_x);
    compare(Knowing(Everything{}(along_x, Knowing(y)) * z), by_x * z);
  }
}

TEST_CASE("a dual knows of which variables it is independent", "[math]") {
  using D = Dual<double, 2, Zeros::known>;
  D const x = D::variable(0.3, 0), y = D::variable(0.8, 1);
  D const only_x = select(x < 0.5, square(x) / 3 - 1, 2 * x) * D(4.0) + exp(x),
          only_y = D(2.0) - log1p(y) / y;
  CHECK(only_x.derivative.may_differ_from_zero(0));
  CHECK_FALSE(only_x.derivative.may_differ_from_zero(1));
  CHECK_FALSE(only_y.derivative.may_differ_from_zero(0));
  CHECK(only_y.derivative.may_differ_from_zero(1));
  for (D const& both : {only_x + only_y, only_x - only_y, only_x * only_y, only_x / only_y})
    for (int k = 0; k < 2; ++k) CHECK(both.derivative.may_differ_from_zero(k));
  CHECK(only_x.derivative[1] == 0);
}

TEST_CASE("a constant has no derivative", "[math]") {
  Dual<float, 3> const c(2);
  CHECK(c.value == 2.0f);
  for (float d : c.derivative) CHECK(d == 0.0f);
  static_assert(std::same_as<builtin_scalar<Dual<Dual<float, 2>, 3>>, float>);
}

}  // namespace pliant::test::dual_test
