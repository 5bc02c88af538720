#pragma once

#include <Eigen/Eigenvalues>

#include <pliant/solver/linear/positive_part.hpp>

namespace pliant::detail {

PLIANT_COMPILED_ONCE void keep_positive_part(Eigen::Ref<Eigen::MatrixXd> a) {
  if (a.size() == 0 || !a.allFinite()) return;
  constexpr double rounding = 1e-13;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> const eigen(a);
  auto const& values = eigen.eigenvalues();  // ascending
  if (values[0] >= -rounding * values.cwiseAbs().maxCoeff()) return;
  auto const n = a.rows();
  for (Eigen::Index m = 0; m < n && values[m] < 0; ++m) {
    auto const* const mode = eigen.eigenvectors().data() + n * m;
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = 0; i < n; ++i) a(i, j) -= values[m] * mode[i] * mode[j];
  }
}

}  // namespace pliant::detail
