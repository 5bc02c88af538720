#pragma once

#include <algorithm>
#include <concepts>
#include <limits>

#include <pliant/solver/refine_in_double.hpp>
#include <pliant/solver/static_matrix_free.hpp>
#include <pliant/solver/static_problem.hpp>

// Statics where the arrays of a body lie, without a matrix.
namespace pliant::detail {

/// Rest that was found in single precision, refined; the report tells what was reached. Returns the residual over the
/// largest of what it is the sum of.
template <DeformableBody TheBody>
double refine_rest(TheBody const& body, NewtonOptions const& options,
                   MatrixFreeStatics<typename TheBody::parts_type>& statics, NewtonReport& report) {
  using Problem = StaticProblem<TheBody>;
  Problem const problem(body, options.gravity);
  Eigen::VectorXd u = Problem::flat(statics.points());
  problem.prescribe(u, body.time());
  auto const evaluate = [&](Eigen::VectorXd const& at) -> DoubleResidual {
    auto const now = assembled_at(body.parts(), at, Assemble::energy_and_force,
                                  std::numeric_limits<double>::infinity(), 1);
    Eigen::VectorXd residual = now.force + problem.external;
    problem.unknowns.keep(residual);
    return {residual, std::max(problem.external.norm(), now.force.norm()), now.energy};
  };
  auto const correct = [&](Eigen::VectorXd const& residual, double gain, Eigen::VectorXd& at) {
    problem.add(at, Problem::flat(statics.correction(Problem::per_node(residual), gain)), 1);
    ++report.iterations;
  };
  double reached = 0;
  for (auto const& left : refine_in_double(u, options.tolerance, evaluate, correct)) {
    report.residual = left.residual;
    report.residuals.push_back(left.residual);
    report.energy = left.energy;
    reached = left.scale > 0 ? left.residual / left.scale : 0;
  }
  statics.set(Problem::per_node(u));
  return reached;
}

/// The displacements in equilibrium, found without a matrix.
template <DeformableBody TheBody>
NewtonReport solve_static_matrix_free(TheBody& body, NewtonOptions const& options) {
  auto& parts = body.parts();
  if (!is_conservative(body))
    throw Error(
        "solve_static: pressures that follow a surface have no symmetric tangent, which conjugate "
        "gradients ask for; take LinearMethod::automatic");
  if (options.tangents != ElementTangents::exact)
    throw Error(
        "solve_static: tangents of elements are projected where they are assembled; take "
        "LinearMethod::automatic, or ElementTangents::exact");
  WithStepSize<typename TheBody::parts_type> const at_rest(parts,
                                                           std::numeric_limits<double>::infinity());
  MatrixFreeStatics<typename TheBody::parts_type> statics(parts, options,
                                                          place_before_drives(parts));
  auto report = statics.solve();
  if constexpr (sizeof(typename TheBody::scalar) < sizeof(double)) {
    double const reached = refine_rest(body, options, statics, report);
    // What single precision holds of displacements; factors in double bring those closer.
    if (options.linear == LinearMethod::automatic &&
        !(reached <= std::max(options.tolerance, 1e-6)))
      throw Error("solve_static: without a matrix the residual stays at ", reached,
                  " of the forces; take LinearMethod::direct");
  }
  change_by_hand(parts, [&] {
    copy_values(parts.backend, statics.displacements().data(), parts.state.u.data(),
                parts.state.u.size());
  });
  return report;
}

/// Whether a body is better solved where its arrays lie.
template <DeformableBody TheBody>
bool lies_better_on_backend(TheBody const& body) {
  using Parts = typename TheBody::parts_type;
  // Unknowns. From some 200 (a cube) to 900 (a slender bar of Hex27) on, a GPU takes less time than factors of a host: at 2475
  // 0.04 to 0.27 of it (H100, H200).
  constexpr Index many = 500;
  return !std::same_as<typename Parts::backend_type::Recording, HostRecording> &&
         is_conservative(body) && TheBody::dim * body.nodes() >= many;
}

}  // namespace pliant::detail
