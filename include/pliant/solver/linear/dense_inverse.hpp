#pragma once

#include <Eigen/Core>

#include <pliant/backend/backend.hpp>
#include <pliant/solver/linear/compiled_once.hpp>

namespace pliant::detail {

/// The inverse of a symmetric matrix that should be positive definite, scaled to a diagonal of ones before. What has no
/// diagonal is no unknown: zero. Where eigenvalues are negative or nearly zero the inverse has their magnitudes, and
/// nothing where they are rounding.
Eigen::MatrixXd inverse_of_definite(Eigen::MatrixXd a);

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

#if !defined(PLIANT_COMPILED_SOLVERS)
#include <pliant/solver/linear/definitions/dense_inverse.hpp>
#endif
