#pragma once

#include <vector>

#include <pliant/solver/element_tangents.hpp>
#include <pliant/solver/least_jacobian.hpp>
#include <pliant/solver/linear/krylov_method.hpp>
#include <pliant/solver/linear/linear_method.hpp>
#include <pliant/solver/mass_product.hpp>

namespace pliant {

/// How solve_static looks for equilibrium.
struct NewtonOptions {
  int load_steps = 1;  // gravity, loads, pressures and motions grow in so many equal steps
  /// How often a load step may be halved where Newton's method does not converge or the answer is folded.
  int load_halvings = 5;
  int max_iterations = 50;  // per load step
  double tolerance =
      1e-11;  // of the residual, relative to the external forces and reactions; below 1
  /// On which masses gravity acts. Consistent, ∫ ρ N g, is as accurate as the elements are; lumped is the
  /// gravity of explicit dynamics, whose rest it finds.
  MassMatrix gravity = MassMatrix::consistent;
  /// For the linear systems: automatic takes a matrix, or none on a GPU where there are 500 unknowns or more
  /// and all forces have a potential. Without one iterations go on in the body's precision;
  /// where that is single, its answer is refined by residuals in double.
  LinearMethod linear = LinearMethod::automatic;
  int max_linear_iterations = 10000;              // without a matrix, per iteration
  KrylovMethod krylov = KrylovMethod::automatic;  // without a matrix
  /// Without a matrix. Kept from iteration to iteration as long as it serves.
  Preconditioner preconditioner = Preconditioner::automatic;
  /// Of the assembled matrix. Projected ones take more iterations near an answer and fewer far from it.
  ElementTangents tangents = ElementTangents::exact;
  bool accept_folded = false;  // an answer that is folded somewhere, instead of an Error
};

/// What solve_static found, and at what cost.
struct NewtonReport {
  Index unknowns = 0;
  int load_steps = 0;      // that were taken
  int iterations = 0;      // in all, those of halved load steps included
  int factorisations = 0;  // of the stiffness
  LinearReport linear;     // what the linear systems took
  int assemblies = 0;      // of the stiffness
  /// N, the last. Of displacements in double precision, which a body in single precision then keeps rounded.
  double residual = 0;
  std::vector<double> residuals;  // N: where each iteration of the last load step began
  double energy = 0;              // strain energy, J
  MassMatrix gravity = MassMatrix::consistent;  // on which masses it acted
  /// Of the last stiffness: where it has a negative pivot, or an iteration without a matrix met a direction of no positive curvature.
  /// The answer is a saddle then, in balance but not stable. Not told where forces have no potential, or tangents are projected.
  bool indefinite = false;
  LeastJacobian least_J{};  // det F where it is least, at points of elements and between them
};

}  // namespace pliant
