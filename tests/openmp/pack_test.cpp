#include <pliant/openmp/pack.hpp>
#include <pliant/openmp/transpose.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"

namespace pliant::test {

// The packs of this build, and those of the narrowest registers.
using Floats = Pack<float>;
using Doubles = Pack<double>;
using FourFloats = Pack<float, 4>;
using TwoDoubles = Pack<double, 2>;

template <class P, class T>
P pack_of(std::vector<T> const& values) {
  P p;
  for (int l = 0; l < P::lanes; ++l) p.v[l] = values[static_cast<std::size_t>(l)];
  return p;
}
template <class P, class T = builtin_scalar<P>>
std::vector<T> random_values(Random& random, double low, double high) {
  std::vector<T> values(P::lanes);
  for (T& x : values) x = static_cast<T>(low + (high - low) * (random() + 1) / 2);
  return values;
}

TEST_CASE("a pack fills one register", "[openmp]") {
  CHECK(sizeof(Floats) == simd_bytes);
  CHECK(sizeof(Doubles) == simd_bytes);
}

TEMPLATE_TEST_CASE("a pack computes in each lane what a number would", "[openmp]", Floats, Doubles,
                   FourFloats, TwoDoubles) {
  using P = TestType;
  using T = builtin_scalar<P>;
  Random random;
  auto const a = random_values<P>(random, -3, 3), b = random_values<P>(random, 1, 4);
  P const x = pack_of<P>(a), y = pack_of<P>(b);
  for (int l = 0; l < P::lanes; ++l) {
    T const s = a[static_cast<std::size_t>(l)], t = b[static_cast<std::size_t>(l)];
    CHECK((x + y)[l] == s + t);
    CHECK((x - y)[l] == s - t);
    CHECK((x * y)[l] == s * t);
    CHECK((x / y)[l] == s / t);
    CHECK((-x)[l] == -s);
    CHECK((2 * x)[l] == 2 * s);
    CHECK(select(x < y, x, y)[l] == std::min(s, t));
    CHECK(pliant::max(x, y)[l] == std::max(s, t));
    CHECK(pliant::abs(x)[l] == std::abs(s));
    CHECK(P(T(-0.0))[l] == 0);
  }
}

TEMPLATE_TEST_CASE("elementary functions of packs are as exact as those of numbers", "[openmp]",
                   Floats, Doubles, FourFloats, TwoDoubles) {
  using P = TestType;
  double const epsilon = 4 * double{std::numeric_limits<builtin_scalar<P>>::epsilon()};
  Random random;
  for (double size : {1e-12, 1e-6, 1e-3, 0.1, 0.9, 10.0}) {
    auto const positive = random_values<P>(random, size / 10, size);
    auto const from_minus_one = random_values<P>(random, -std::min(size, 0.9), size);
    P const x = pack_of<P>(positive), z = pack_of<P>(from_minus_one);
    for (int l = 0; l < P::lanes; ++l) {
      auto const s = static_cast<double>(positive[static_cast<std::size_t>(l)]);
      auto const t = static_cast<double>(from_minus_one[static_cast<std::size_t>(l)]);
      INFO(s << ", " << t);
      CHECK(double{sqrt(x)[l]} == Approx(std::sqrt(s)).epsilon(epsilon));
      CHECK(double{exp(z)[l]} == Approx(std::exp(t)).epsilon(epsilon));
      CHECK(double{log(x)[l]} == Approx(std::log(s)).epsilon(epsilon).margin(epsilon / 4));
      CHECK(double{log1p(z)[l]} == Approx(std::log1p(t)).epsilon(epsilon).margin(0));
      CHECK(double{expm1(z)[l]} == Approx(std::expm1(t)).epsilon(epsilon).margin(0));
      CHECK(double{cbrt(z)[l]} == Approx(std::cbrt(t)).epsilon(epsilon).margin(0));
    }
  }
}

TEMPLATE_TEST_CASE("the cube root of nothing is nothing", "[openmp]", Floats, Doubles, FourFloats,
                   TwoDoubles) {
  CHECK(cbrt(TestType(0))[0] == 0);
}

TEMPLATE_TEST_CASE("gathering and scattering move whole nodes", "[openmp]", Floats, Doubles,
                   FourFloats, TwoDoubles) {
  using T = builtin_scalar<TestType>;
  constexpr int lanes = TestType::lanes;
  std::vector<T> field(4 * 50);
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = static_cast<T>(i);
  Index nodes[lanes];
  for (int l = 0; l < lanes; ++l) nodes[l] = (7 * l + 3) % 50;
  nodes[1] = nodes[0];  // two lanes may share a node
  typename TestType::Register gathered[4];

  detail::gather_nodes<T, lanes>(field.data(), nodes, gathered);
  for (int l = 0; l < lanes; ++l)
    for (int k = 0; k < 4; ++k) CHECK(gathered[k][l] == static_cast<T>(4 * nodes[l] + k));

  for (int count : {lanes, lanes - 1}) {  // the last lane may be no element
    std::vector<T> sums(field.size(), T(1));
    auto expected = sums;
    typename TestType::Register r[4];
    for (int k = 0; k < 4; ++k) r[k] = gathered[k];
    for (int l = 0; l < count; ++l)
      for (int k = 0; k < 4; ++k) expected[static_cast<std::size_t>(4 * nodes[l] + k)] += r[k][l];
    detail::scatter_add_nodes<T, lanes>(sums.data(), nodes, count, r);
    CHECK(sums == expected);
  }
}

}  // namespace pliant::test
