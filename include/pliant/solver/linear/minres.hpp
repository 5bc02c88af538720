#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Core>

#include <pliant/solver/linear/minres_numbers.hpp>
#include <pliant/solver/linear/true_residual.hpp>

namespace pliant::detail {

/// The steps of minres, until their recursion claims that it is done.
template <class A, class M>
KrylovReport minres_recursion(A const& apply_a, M const& apply_m, Eigen::VectorXd const& b,
                              Eigen::VectorXd& x, double tolerance, int max_iterations) {
  using Vector = Eigen::VectorXd;
  Vector const zero = Vector::Zero(b.size());
  Vector r = b, v = b, v_before = zero, w = zero, w_before = zero, z, q;
  x = zero;
  apply_m(v, z);
  auto k = MinresNumbers::first(v.dot(z), std::numeric_limits<double>::epsilon());
  KrylovReport report;
  for (double const size = b.norm();; ++report.iterations) {
    report.residual = r.norm();
    report.converged = report.residual <= tolerance * size;
    report.indefinite = k.indefinite;
    if (report.converged || report.iterations == max_iterations || !std::isfinite(report.residual))
      return report;
    Vector const p = z / k.gamma;
    apply_a(p, q);
    double const delta = p.dot(q);
    v_before = q - delta / k.gamma * v - k.gamma / k.gamma_before * v_before;
    std::swap(v, v_before);
    apply_m(v, z);
    k.rotate(delta, v.dot(z));
    if (k.state != MinresNumbers::State::goes_on) {
      report.indefinite = k.indefinite || k.state == MinresNumbers::State::unfit;
      return report;
    }
    w_before = (p - k.alpha_2 * w - k.alpha_3 * w_before) / k.alpha_1;
    std::swap(w, w_before);
    x += k.ahead * w;
    r = k.kept * r - k.taken * v;
  }
}

/// Solves A x = b for a symmetric A, from x = 0, until |b − A x| ≤ tolerance |b|, computed from x (Paige and Saunders, SIAM
/// Journal on Numerical Analysis 12 (1975) 617; preconditioned as in Elman, Silvester and Wathen, Finite Elements and Fast
/// Iterative Solvers, 2014, algorithm 4.1). apply_a(v, out) sets out = A v, apply_m(r, out) an approximation of |A|⁻¹ r that is
/// symmetric positive definite. A may be singular where b is an image of it; where it is not, the iteration ends without
/// having converged.
template <class A, class M>
KrylovReport minres(A const& apply_a, M const& apply_m, Eigen::VectorXd const& b,
                    Eigen::VectorXd& x, double tolerance, int max_iterations) {
  return solve_to_true_residual(
      apply_a, b, x, tolerance, max_iterations,
      [&](Eigen::VectorXd const& r, Eigen::VectorXd& change, double share, int most) {
        return minres_recursion(apply_a, apply_m, r, change, share, most);
      });
}

}  // namespace pliant::detail
