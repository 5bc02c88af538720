#pragma once

#include <cmath>

#include <Eigen/Eigenvalues>

#include <pliant/solver/linear/dense_inverse.hpp>

namespace pliant::detail {

/// Replaces a matrix by its inverse, row by row (Gauss and Jordan). False, with the matrix lost, where a pivot is not above
/// `least`.
PLIANT_COMPILED_ONCE bool invert_in_place(Eigen::MatrixXd& a, double least) {
  auto const n = a.rows();
  for (Eigen::Index k = 0; k < n; ++k) {
    double const pivot = a(k, k);
    if (!(pivot > least)) return false;
    double* const own = a.data() + n * k;  // a column
    own[k] = 1;
    for (Eigen::Index i = 0; i < n; ++i) own[i] /= pivot;
    for (Eigen::Index j = 0; j < n; ++j) {
      double* const other = a.data() + n * j;
      double const factor = other[k];
      if (j == k || factor == 0) continue;
      other[k] = 0;
      for (Eigen::Index i = 0; i < n; ++i) other[i] -= factor * own[i];
    }
  }
  return true;
}

PLIANT_COMPILED_ONCE Eigen::MatrixXd inverse_of_definite(Eigen::MatrixXd a) {
  auto const n = a.rows();
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) scale[i] = a(i, i) > 0 ? 1 / std::sqrt(a(i, i)) : 0;
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i) a(i, j) *= scale[i] * scale[j];
  for (Eigen::Index i = 0; i < n; ++i)
    if (scale[i] == 0) a(i, i) = 1;
  constexpr double least = 1e-9;
  Eigen::MatrixXd inverse = a;
  if (!invert_in_place(inverse, least)) {
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> const eigen(a);
    inverse.setZero();
    for (Eigen::Index m = 0; m < n; ++m) {
      double const value = std::abs(eigen.eigenvalues()[m]);
      if (!(value > least)) continue;
      auto const* const mode = eigen.eigenvectors().data() + n * m;
      for (Eigen::Index j = 0; j < n; ++j)
        for (Eigen::Index i = 0; i < n; ++i) inverse(i, j) += mode[i] * mode[j] / value;
    }
  }
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i <= j; ++i)
      inverse(i, j) = inverse(j, i) = scale[i] * scale[j] * (inverse(i, j) + inverse(j, i)) / 2;
  return inverse;
}

}  // namespace pliant::detail
