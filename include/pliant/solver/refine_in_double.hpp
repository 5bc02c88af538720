#pragma once

#include <algorithm>
#include <limits>

#include <pliant/solver/assemble.hpp>
#include <pliant/solver/newton_options.hpp>
#include <pliant/solver/static_problem.hpp>

namespace pliant::detail {

/// Iterative refinement of rest that was found in single precision: residuals and displacements in double precision, on
/// the host, corrections in the body's own (Higham, Accuracy and Stability of Numerical Algorithms, 2002, chapter 12).
/// Ends within the tolerance, or where corrections no longer halve the residual; the report tells what was reached.
/// Of `statics` it takes points(), correction(residual, tolerance) and set(points), node by node in the user's order.
template <DeformableBody TheBody, class Statics>
void refine_in_double(TheBody const& body, NewtonOptions const& options, Statics& statics,
                      NewtonReport& report) {
  using Problem = StaticProblem<TheBody>;
  constexpr double gain = 1e-4;  // of a correction
  Problem const problem(body, options.gravity);
  Eigen::VectorXd best, u = Problem::flat(statics.points());
  problem.prescribe(u, body.time());
  for (double before = std::numeric_limits<double>::infinity();;) {
    auto const now = assembled_at(body.parts(), u, Assemble::energy_and_force,
                                  std::numeric_limits<double>::infinity(), 1);
    Eigen::VectorXd residual = now.force + problem.external;
    problem.unknowns.keep(residual);
    double const left = residual.norm(),
                 scale = std::max(problem.external.norm(), now.force.norm());
    if (!(left < before)) break;
    best = u;
    report.residual = left;
    report.residuals.push_back(left);
    report.energy = now.energy;
    if (left <= options.tolerance * scale || left > before / 2) break;
    before = left;
    problem.add(u, Problem::flat(statics.correction(Problem::per_node(residual), gain)), 1);
    ++report.iterations;
  }
  if (best.size() > 0) statics.set(Problem::per_node(best));
}

}  // namespace pliant::detail
