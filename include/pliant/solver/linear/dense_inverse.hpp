#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include <pliant/backend/backend.hpp>

namespace pliant::detail {

/// The inverse of a symmetric matrix that should be positive definite, scaled to a diagonal of ones before. What has no
/// diagonal is no unknown: zero. Where eigenvalues are negative or nearly zero the inverse has their magnitudes, and
/// nothing where they are rounding.
inline Eigen::MatrixXd inverse_of_definite(Eigen::MatrixXd a) {
  auto const n = a.rows();
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) scale[i] = a(i, i) > 0 ? 1 / std::sqrt(a(i, i)) : 0;
  a = scale.asDiagonal() * a * scale.asDiagonal();
  for (Eigen::Index i = 0; i < n; ++i)
    if (scale[i] == 0) a(i, i) = 1;
  constexpr double least = 1e-9;
  Eigen::LDLT<Eigen::MatrixXd> const factors(a);
  Eigen::MatrixXd inverse;
  if (factors.info() == Eigen::Success && factors.vectorD().minCoeff() > least) {
    inverse = factors.solve(Eigen::MatrixXd::Identity(n, n));
  } else {
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> const eigen(a);
    auto const& values = eigen.eigenvalues();
    Eigen::VectorXd inverses(n);
    for (Eigen::Index i = 0; i < n; ++i)
      inverses[i] = std::abs(values[i]) > least ? 1 / std::abs(values[i]) : 0;
    inverse = eigen.eigenvectors() * inverses.asDiagonal() * eigen.eigenvectors().transpose();
  }
  inverse = scale.asDiagonal() * inverse * scale.asDiagonal();
  return (inverse + inverse.transpose()) / 2;
}

/// y = A x of a symmetric dense matrix: numbers (node, direction).
template <class T, int Dim>
struct DenseProduct {
  T const* a;
  Index size;  // nodes · Dim
  NodeField<T, Dim> y;
  NodeField<T const, Dim> x;
  PLIANT_HOST_DEVICE void operator()(Index row) const {
    T sum = T(0);
    T const* entry = a + row;
    for (Index j = 0; j < size / Dim; ++j)
      for (int k = 0; k < Dim; ++k, entry += size) sum += *entry * x(j, k);
    y(row / Dim, row % Dim) = sum;
  }
};

}  // namespace pliant::detail
