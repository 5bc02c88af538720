#pragma once

#include <Eigen/Core>

#include <pliant/solver/linear/krylov_report.hpp>

namespace pliant::detail {

/// Solves A x = b from x = 0 by a Krylov method, whose recursion does not know how x was rounded: `method(r, x, tolerance,
/// max_iterations)` solves A x = r from 0 and claims to have converged; it is asked again, for what b − A x, computed from
/// x, is still above tolerance |b|, as long as that halves it. The report tells this residual.
template <class A, class Method>
KrylovReport solve_to_true_residual(A const& apply_a, Eigen::VectorXd const& b, Eigen::VectorXd& x,
                                    double tolerance, int max_iterations, Method const& method) {
  KrylovReport all;
  Eigen::VectorXd r = b, change, image;
  x.setZero(b.size());
  double const enough = tolerance * b.norm();
  all.residual = b.norm();
  for (;;) {
    double const before = all.residual;
    auto const found = method(r, change, before > 0 ? enough / before : tolerance,
                              max_iterations - all.iterations);
    all.iterations += found.iterations;
    all.indefinite = found.indefinite;
    x += change;
    apply_a(x, image);
    r = b - image;
    all.residual = r.norm();
    all.converged = found.converged && all.residual <= enough;
    if (all.converged || !found.converged || all.iterations >= max_iterations ||
        !(all.residual <= before / 2))
      return all;
  }
}

}  // namespace pliant::detail
