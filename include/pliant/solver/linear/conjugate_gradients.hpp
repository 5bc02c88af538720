#pragma once

#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/Core>

#include <pliant/solver/linear/true_residual.hpp>

namespace pliant::detail {

/// The steps of conjugate_gradients, until their recursion claims that it is done.
template <class A, class M>
KrylovReport gradient_recursion(A const& apply_a, M const& apply_m, Eigen::VectorXd const& b,
                                Eigen::VectorXd& x, double tolerance, int max_iterations) {
  constexpr int few = 3;
  KrylovReport report;
  Eigen::VectorXd q, z, r = b, p;
  x.setZero(b.size());
  double const size = b.norm();
  double rz = 0, all = 0;            // all: |x|² in the norm of A
  std::array<double, few> gained{};  // in the last steps
  for (;; ++report.iterations) {
    report.residual = r.norm();
    double const late = std::accumulate(gained.begin(), gained.end(), 0.0);
    report.converged = report.residual <= tolerance * size && late <= tolerance * tolerance * all;
    if (report.converged || report.iterations == max_iterations || !std::isfinite(report.residual))
      return report;
    apply_m(r, z);
    double const rz_before = std::exchange(rz, r.dot(z));
    if (rz > 0) {
      p = report.iterations == 0 ? z : Eigen::VectorXd(z + rz / rz_before * p);
      apply_a(p, q);
    }
    double const curvature = rz > 0 ? p.dot(q) : 0;
    if (!(curvature > 0)) {
      report.indefinite = true;
      return report;
    }
    double const alpha = rz / curvature;
    x += alpha * p;
    r -= alpha * q;
    all += gained[static_cast<std::size_t>(report.iterations % few)] = alpha * rz;
  }
}

/// Solves A x = b for a symmetric positive definite A, from x = 0, until |b − A x| ≤ tolerance |b|, computed from x, and the
/// same holds of the error in the norm of A, as far as the last few steps tell it (Hestenes and Stiefel 1952; Strakoš and Tichý,
/// Electronic Transactions on Numerical Analysis 13 (2002) 56). apply_a(v, out) sets out = A v, apply_m(r, out) an
/// approximation of A⁻¹ r that is symmetric positive definite.
template <class A, class M>
KrylovReport conjugate_gradients(A const& apply_a, M const& apply_m, Eigen::VectorXd const& b,
                                 Eigen::VectorXd& x, double tolerance, int max_iterations) {
  return solve_to_true_residual(
      apply_a, b, x, tolerance, max_iterations,
      [&](Eigen::VectorXd const& r, Eigen::VectorXd& change, double share, int most) {
        return gradient_recursion(apply_a, apply_m, r, change, share, most);
      });
}

}  // namespace pliant::detail
