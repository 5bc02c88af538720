#include <Eigen/Dense>

#include <pliant/math/matrix.hpp>

#include "support/catch.hpp"
#include "support/random.hpp"

namespace pliant::test::matrix_test {

template <int R, int C>
Eigen::Matrix<double, R, C> in_eigen(Matrix<double, R, C> const& a) {
  Eigen::Matrix<double, R, C> b;
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < C; ++j) b(i, j) = a(i, j);
  return b;
}

TEMPLATE_TEST_CASE_SIG("small tensors agree with Eigen", "[math]", ((int N), N), 2, 3) {
  Random random;
  for (int k = 0; k < 20; ++k) {
    auto const a = random.tensor<N>(1), b = random.tensor<N>(1);
    auto const ea = in_eigen(a), eb = in_eigen(b);
    CHECK((in_eigen(a * b) - ea * eb).norm() < 1e-15);
    CHECK((in_eigen(a + 2 * b - transpose(a)) - (ea + 2 * eb - ea.transpose())).norm() < 1e-15);
    CHECK((in_eigen(symmetric_part(a)) - (ea + ea.transpose()) / 2).norm() < 1e-15);
    CHECK(trace(a) == Approx(ea.trace()).epsilon(1e-14).margin(1e-15));
    CHECK(dot(a, b) == Approx((ea.array() * eb.array()).sum()).epsilon(1e-13).margin(1e-15));
    CHECK(norm(a) == Approx(ea.norm()).epsilon(1e-14));
    CHECK(determinant(a) == Approx(ea.determinant()).epsilon(1e-12).margin(1e-15));
    CHECK((in_eigen(cofactor(a)) - ea.determinant() * ea.inverse().transpose()).norm() < 1e-12);
  }
}

TEMPLATE_TEST_CASE_SIG("determinant and cofactors near the identity keep their digits", "[math]",
                       ((int N), N), 2, 3) {
  Random random;
  auto const identity = Tensor<double, N>::identity();
  for (double size : {1.0, 1e-3}) {
    auto const h = random.tensor<N>(size);
    CHECK(determinant_less_one(h) == Approx(determinant(identity + h) - 1).margin(1e-15));
    CHECK(norm(cofactor_less_identity(h) - (cofactor(identity + h) - identity)) < 1e-14);
  }
  // det(I + h) = 1 + tr h to first order: nothing of a tiny h is rounded away.
  auto const tiny = random.tensor<N>(1e-20);
  CHECK(determinant_less_one(tiny) == Approx(trace(tiny)).epsilon(1e-14));
  auto const c = cofactor_less_identity(tiny);
  CHECK(c(0, 1) == Approx(-tiny(1, 0)).epsilon(1e-14));
}

}  // namespace pliant::test::matrix_test
