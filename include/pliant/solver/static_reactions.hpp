#pragma once

#include <algorithm>

#include <pliant/solver/linear/same_registers.hpp>
#include <pliant/solver/static_problem.hpp>

namespace pliant {

/// The forces that a condition exerts on a body in static equilibrium, N, at each of its nodes in ascending
/// order: what balances internal forces, loads and gravity there. As reactions(body, handle), with gravity
/// on the masses that solve_static put it on, so that all reactions together bear the body's weight.
/// Throws Error for a handle that names no condition of the body.
template <DeformableBody TheBody>
std::vector<Point<TheBody::dim>> static_reactions(TheBody const& body, Handle handle,
                                                  MassMatrix gravity = MassMatrix::consistent) {
  constexpr int dim = TheBody::dim;
  auto const& conditions = body.state().prescribed->conditions;
  auto const found = std::ranges::find(conditions, handle, &Condition<dim>::handle);
  if (found == conditions.end())
    throw Error("static_reactions: handle ", handle.id, " names no condition of this body");
  detail::check_registers();
  detail::StaticProblem<TheBody> const problem(body, gravity);
  Eigen::VectorXd const pull =
      assemble(body, problem.start(), std::numeric_limits<double>::infinity(),
               Assemble::energy_and_force)
          .force +
      problem.external;
  std::vector<Point<dim>> forces;
  for (Index node : found->nodes) {
    Point<dim>& force = forces.emplace_back();
    for (int k = 0; k < dim; ++k)
      if (found->directions >> k & 1)
        force[static_cast<std::size_t>(k)] = -pull[Eigen::Index{dim} * node + k];
  }
  return forces;
}

}  // namespace pliant
