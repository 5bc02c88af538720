#include <Eigen/Eigenvalues>

#include <pliant/math/eigenvalue_bounds.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"

namespace pliant::test::eigenvalue_bounds_test {

/// A number in [from, to].
inline double between(double from, double to, Random& random) {
  return from + (to - from) * (random() + 1) / 2;
}

/// A symmetric matrix with the given eigenvalues and eigenvectors at random.
template <int N>
Eigen::MatrixXd with_eigenvalues(Eigen::VectorXd const& values, Random& random) {
  Eigen::MatrixXd a(N, N);
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) a(i, j) = random();
  Eigen::MatrixXd const q = Eigen::HouseholderQR<Eigen::MatrixXd>(a).householderQ();
  return q * values.asDiagonal() * q.transpose();
}

template <class T, int N>
T by_products(Eigen::MatrixXd const& a) {
  return detail::bound_by_products<T, N>([&](Vector<T, N> const& x) {
    auto product = Vector<T, N>::zero();
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) product[i] = product[i] + static_cast<T>(a(i, j)) * x[j];
    return product;
  });
}
template <class T, int N>
T by_powers(Eigen::MatrixXd const& a) {
  Tensor<T, N> entries;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) entries(i, j) = static_cast<T>(a(i, j));
  return detail::bound_by_powers(entries);
}

template <int N, class Bound>
void check(Bound const& bound, double most) {
  Random random(7);
  for (int round = 0; round < 40; ++round) {
    Eigen::VectorXd values(N);
    for (int i = 0; i < N; ++i) values[i] = between(0, 1, random);
    if (round % 4 == 1) values *= -1;
    if (round % 4 == 2) values[0] = -values.maxCoeff() * between(0, 1.5, random);
    if (round % 4 == 3) values.head(N - 3).setZero();
    values *= std::pow(10.0, between(-20, 20, random));
    double const exact = values.cwiseAbs().maxCoeff();
    INFO("round " << round << ", " << exact);

    double const found = bound(with_eigenvalues<N>(values, random));

    CHECK(found >= exact);
    CHECK(found <= most * exact);
  }
}

TEST_CASE("bounds of eigenvalues are above them and near", "[math]") {
  check<60>([](auto const& a) { return by_products<double, 60>(a); }, 1.26);
  check<81>([](auto const& a) { return by_products<double, 81>(a); }, 1.26);
  check<81>([](auto const& a) { return by_products<float, 81>(a); }, 1.26);
  check<9>([](auto const& a) { return by_powers<double, 9>(a); }, std::pow(9, 0.125));
  check<24>([](auto const& a) { return by_powers<double, 24>(a); }, std::pow(24, 0.125));
  check<24>([](auto const& a) { return by_powers<float, 24>(a); }, std::pow(24, 0.125));
}

TEST_CASE("bounds of eigenvalues of definite matrices are a tenth above them", "[math]") {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    Eigen::VectorXd values(81);
    for (int i = 0; i < 81; ++i) values[i] = std::exp(between(-8, 8, random));

    double const found = by_products<double, 81>(with_eigenvalues<81>(values, random));

    CHECK(found == Approx(1.1 * values.maxCoeff()).epsilon(0.002));
  }
}

TEST_CASE("bounds of eigenvalues are no numbers where matrices are not, and zero for zero",
          "[math]") {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(81, 81);
  CHECK(by_products<double, 81>(0 * a) == 0);
  CHECK(by_powers<double, 81>(0 * a) == 0);
  CHECK(by_products<double, 81>(a) >= 1);
  for (double const wrong : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    a(80, 3) = a(3, 80) = wrong;
    CHECK_FALSE(std::isfinite(by_products<double, 81>(a)));
    CHECK_FALSE(std::isfinite(by_powers<double, 81>(a)));
  }
}

}  // namespace pliant::test::eigenvalue_bounds_test
