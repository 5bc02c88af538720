#pragma once

#include <limits>
#include <vector>

#include <pliant/solver/assemble.hpp>

namespace pliant::detail {

/// A residual in double precision.
struct DoubleResidual {
  Eigen::VectorXd residual;  // N
  double scale;              // N: the largest of what it is the sum of
  double energy = 0;         // J, where it has one
};
/// What of it was left.
struct Refined {
  double residual, scale, energy;
};

/// Iterative refinement of an answer u that was found in single precision: residuals and u in double precision, on the
/// host, corrections in the body's own (Higham, Accuracy and Stability of Numerical Algorithms, 2002, chapter 12). Ends within
/// the tolerance, or where corrections no longer halve the residual, at the best of them. `evaluate(u)` is a DoubleResidual, `correct(residual,
/// gain, u)` adds to u what a residual asks for, to such a relative accuracy. Returns what each was left of, the best last.
template <class Evaluate, class Correct>
std::vector<Refined> refine_in_double(Eigen::VectorXd& u, double tolerance,
                                      Evaluate const& evaluate, Correct const& correct) {
  constexpr double gain = 1e-4;  // of a correction
  std::vector<Refined> left;
  Eigen::VectorXd best = u;
  for (double before = std::numeric_limits<double>::infinity();;) {
    DoubleResidual const now = evaluate(u);
    double const size = now.residual.norm();
    if (!(size < before)) break;
    best = u;
    left.push_back({size, now.scale, now.energy});
    if (size <= tolerance * now.scale || size > before / 2) break;
    before = size;
    correct(now.residual, gain, u);
  }
  u = best;
  return left;
}

}  // namespace pliant::detail
