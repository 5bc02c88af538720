#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include <pliant/solver/linear/compiled_once.hpp>

namespace pliant::detail {

/// The tridiagonal matrix of Lanczos' method, in the inner product of the preconditioner, as conjugate gradients make
/// it (see Saad, Numerical Methods for Large Eigenvalue Problems, 2011).
class LanczosMatrix {
 public:
  /// A step's α = rᵀz / pᵀAp, and the β that led to its p. False where the matrix is not positive definite.
  bool add(double alpha, double beta) {
    if (!std::isfinite(alpha) || !(alpha > 0)) return false;
    double const before = std::exchange(alpha_, alpha);
    if (!diagonal_.empty()) beside_.push_back(std::sqrt(beta) / before);
    diagonal_.push_back(1 / alpha + beta / before);
    return true;
  }
  /// The largest eigenvalue, which comes from below and closely to that of the preconditioned matrix; 1 without steps.
  double largest() const;

 private:
  std::vector<double> diagonal_, beside_;
  double alpha_ = 1;
};

}  // namespace pliant::detail

#if !defined(PLIANT_COMPILED_SOLVERS)
#include <pliant/solver/linear/definitions/lanczos_matrix.hpp>
#endif
