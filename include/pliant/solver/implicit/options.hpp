#pragma once

#include <optional>

#include <pliant/solver/least_jacobian.hpp>
#include <pliant/solver/linear/krylov_method.hpp>
#include <pliant/solver/linear/linear_method.hpp>
#include <pliant/solver/mass_product.hpp>

namespace pliant {

/// What implicit integrators make of the errors of their steps.
enum class ErrorEstimate {
  automatic,  // carried where steps follow their error
  added_up,  // a sum: no bound where motions part by themselves, as of bodies that buckle, snap or are hit
  /// Along with the motion by its tangent, which tells how errors grow or die out: for a linear system more in each step,
  /// solved to a hundredth.
  carried
};

/// How implicit integrators step.
struct ImplicitOptions {
  double step = 0;  // s, positive and finite; the first one where steps follow their error
  MassMatrix mass = MassMatrix::consistent;  // for inertia, gravity and mass damping
  double stiffness_damping =
      0;  // s: forces −s K(u) v, K the stiffness where a step begins (Rayleigh)
  /// m: steps become as long as the error of each, told from what it has beyond an extrapolation, is at the largest
  /// displacement; 0: all steps are the same.
  double error = 0;
  ErrorEstimate errors = ErrorEstimate::automatic;
  int max_iterations = 30;  // of Newton's method, per step
  /// Of the residual, relative to the largest of the forces; below 1. Unset: 1e-10, and in single precision what that tells. Bodies
  /// in single precision are brought to one that is set by residuals in double precision, on the host, where their own do
  /// not tell enough; they then keep the answer rounded.
  std::optional<double> tolerance{};
  /// Automatic: on hosts with a matrix, on GPUs without; there with one (on the host) in steps that find no other way.
  LinearMethod linear = LinearMethod::automatic;
  int max_linear_iterations = 10000;              // without a matrix, per iteration
  KrylovMethod krylov = KrylovMethod::automatic;  // without a matrix
  /// Without a matrix. Kept from iteration to iteration of a step as long as it serves.
  Preconditioner preconditioner = Preconditioner::automatic;
  bool accept_folded = false;  // steps that fold the body somewhere, instead of an Error
};

/// What a call of an implicit integrator did, and at what cost.
struct ImplicitReport {
  int steps = 0;     // taken
  int rejected = 0;  // and others that were too long
  double time = 0;   // s: where the body is now
  double step = 0;   // s: the size of the last step
  double error = 0;  // m: of the last step, as its extrapolation tells
  /// m: by how much displacements may be off. Carried errors: at any time since the motion began, or was changed by
  /// hand. Added up: by these steps, twice their sum, as each is an error of the velocity too, which displaces as much again.
  double error_in_all = 0;
  ErrorEstimate errors = ErrorEstimate::added_up;  // or carried
  /// Carried errors have come to a tenth of all displacements, or had no solution, so that their tangent is not that of the
  /// motion any more: where the body is by now is not known. Take shorter steps from the start.
  bool errors_lost = false;
  int iterations = 0;      // of Newton's method, in all
  int factorisations = 0;  // of matrices, in all
  LinearReport linear{};   // what the linear systems took
  double residual = 0;     // N, of the last step
  /// The largest residual of these steps over the forces that it is the sum of: above the tolerance where steps ended as
  /// the body's precision tells no more of its displacements, and no tolerance was set.
  double reached = 0;
  int corrections = 0;  // of bodies in single precision by residuals in double
  LeastJacobian
      least_J{};  // det F where it is least at the ends of these steps, at points of elements and between
};

}  // namespace pliant
