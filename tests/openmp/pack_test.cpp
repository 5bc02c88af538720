#include <pliant/openmp/pack.hpp>
#include <pliant/openmp/transpose.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"

namespace pliant::test {

template <class T>
Pack<T> pack_of(std::vector<T> const& values) {
  Pack<T> p;
  for (int l = 0; l < Pack<T>::lanes; ++l) p.v[l] = values[static_cast<std::size_t>(l)];
  return p;
}
template <class T>
std::vector<T> random_values(Random& random, T low, T high) {
  std::vector<T> values(Pack<T>::lanes);
  for (T& x : values) x = low + (high - low) * static_cast<T>((random() + 1) / 2);
  return values;
}

TEMPLATE_TEST_CASE("a pack computes in each lane what a number would", "[openmp]", float, double) {
  using P = Pack<TestType>;
  Random random;
  auto const a = random_values<TestType>(random, -3, 3), b = random_values<TestType>(random, 1, 4);
  P const x = pack_of(a), y = pack_of(b);
  for (int l = 0; l < P::lanes; ++l) {
    TestType const s = a[static_cast<std::size_t>(l)], t = b[static_cast<std::size_t>(l)];
    CHECK((x + y)[l] == s + t);
    CHECK((x - y)[l] == s - t);
    CHECK((x * y)[l] == s * t);
    CHECK((x / y)[l] == s / t);
    CHECK((-x)[l] == -s);
    CHECK((2 * x)[l] == 2 * s);
    CHECK(select(x < y, x, y)[l] == std::min(s, t));
    CHECK(pliant::max(x, y)[l] == std::max(s, t));
    CHECK(pliant::abs(x)[l] == std::abs(s));
    CHECK(P(TestType(-0.0))[l] == 0);
  }
}

TEMPLATE_TEST_CASE("elementary functions of packs are as exact as those of numbers", "[openmp]",
                   float, double) {
  using P = Pack<TestType>;
  double const epsilon = 4 * double{std::numeric_limits<TestType>::epsilon()};
  Random random;
  for (double size : {1e-12, 1e-6, 1e-3, 0.1, 0.9, 10.0}) {
    auto const positive = random_values<TestType>(random, TestType(size / 10), TestType(size));
    auto const from_minus_one =
        random_values<TestType>(random, TestType(-std::min(size, 0.9)), TestType(size));
    P const x = pack_of(positive), z = pack_of(from_minus_one);
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

TEMPLATE_TEST_CASE("the cube root of nothing is nothing", "[openmp]", float, double) {
  CHECK(cbrt(Pack<TestType>(0))[0] == 0);
}

TEMPLATE_TEST_CASE("gathering and scattering move whole nodes", "[openmp]", float, double) {
  constexpr int lanes = Pack<TestType>::lanes;
  std::vector<TestType> field(4 * 50);
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = static_cast<TestType>(i);
  Index nodes[lanes];
  for (int l = 0; l < lanes; ++l) nodes[l] = (7 * l + 3) % 50;
  nodes[1] = nodes[0];  // two lanes may share a node
  typename Pack<TestType>::Register r[4];

  detail::gather_nodes<TestType, lanes>(field.data(), nodes, r);
  for (int l = 0; l < lanes; ++l)
    for (int k = 0; k < 4; ++k) CHECK(r[k][l] == static_cast<TestType>(4 * nodes[l] + k));

  std::vector<TestType> sums(field.size(), TestType(1));
  auto expected = sums;
  int const count = lanes - 1;  // the last lane is no element
  for (int l = 0; l < count; ++l)
    for (int k = 0; k < 4; ++k) expected[static_cast<std::size_t>(4 * nodes[l] + k)] += r[k][l];
  detail::scatter_add_nodes<TestType, lanes>(sums.data(), nodes, count, r);
  CHECK(sums == expected);
}

}  // namespace pliant::test
