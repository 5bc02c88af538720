#pragma once

#include <pliant/body/solver_arrays.hpp>
#include <pliant/solver/assemble_mass.hpp>
#include <pliant/solver/linear/linear_solver.hpp>
#include <pliant/solver/linear/shifted_tangent.hpp>
#include <pliant/solver/static_problem.hpp>

namespace pliant::detail {

/// Solves the linear systems of implicit steps on the assembled matrix, on the host in double precision.
template <DeformableBody TheBody>
class AssembledSteps {
  static constexpr int dim = TheBody::dim;
  using Parts = typename TheBody::parts_type;
  using Problem = StaticProblem<TheBody>;

 public:
  AssembledSteps(TheBody const& body, MassMatrix mass, LinearSolver<dim>& linear)
      : body_(body),
        tasks_(body.parts().backend),
        unknowns_(Problem::fixed_entries(body)),
        mass_(mass_blocks(body, mass)),
        conservative_(is_conservative(body)),
        linear_(linear) {}

  /// A⁻¹ residual to a relative tolerance, into arrays.solution, for laws that see a step dt, s.
  void solve(SolverArrays<typename Parts::backend_type>& arrays, ShiftedTangent<Parts> const& a,
             double dt, double tolerance) {
    auto const& layout = body_.parts().layout;
    auto const flat = [&](auto const& array) { return Problem::flat(layout.in_user_order(array)); };
    assemble_into(matrix_, body_.parts(), flat(arrays.place), Assemble::stiffness, dt, 1);
    auto& sum = matrix_.stiffness;
    for (double& x : sum.values) x *= a.stiffness;
    if (a.damping != 0) {
      assemble_into(damping_, body_.parts(), flat(body_.state().u), Assemble::stiffness, dt, 1);
      add(a.damping, damping_.stiffness, sum);
    }
    add(a.inertia, mass_, sum);
    auto const x = linear_.solve(tasks_, {sum, unknowns_, body_.mesh().nodes, conservative_},
                                 flat(arrays.residual), tolerance);
    arrays.solution.upload(layout.padded(Problem::per_node(x)));
    layout.interpolation.apply(body_.parts().backend, node_field<dim>(arrays.solution));
  }

 private:
  /// to += factor · from, where `to` has a place for each block.
  static void add(double factor, BlockMatrix<dim, dim> const& from, BlockMatrix<dim, dim>& to) {
    for (Index row = 0; row < from.rows(); ++row)
      for (auto place = from.begin(row); place < from.end(row); ++place) {
        double* const block = to.at(to.find(row, from.column_at(place)));
        for (int k = 0; k < dim * dim; ++k) block[k] += factor * from.at(place)[k];
      }
  }

  TheBody const& body_;
  HostTasks tasks_;
  Unknowns unknowns_;
  BlockMatrix<dim, dim> mass_;
  bool conservative_;
  LinearSolver<dim>& linear_;
  AssembledBlocks<dim> matrix_, damping_;
};

}  // namespace pliant::detail
