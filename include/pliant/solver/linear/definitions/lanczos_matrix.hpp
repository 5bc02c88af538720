#pragma once

#include <Eigen/Eigenvalues>

#include <pliant/solver/linear/lanczos_matrix.hpp>

namespace pliant::detail {

PLIANT_COMPILED_ONCE double LanczosMatrix::largest() const {
  if (diagonal_.empty()) return 1;
  Eigen::VectorXd const d = Eigen::VectorXd::Map(diagonal_.data(), std::ssize(diagonal_));
  Eigen::VectorXd const e = Eigen::VectorXd::Map(beside_.data(), std::ssize(beside_));
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;
  eigen.computeFromTridiagonal(d, e, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().maxCoeff();
}

}  // namespace pliant::detail
