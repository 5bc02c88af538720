#pragma once

#include <pliant/backend/field.hpp>
#include <pliant/config.hpp>

namespace pliant::detail {

/// The numbers of a Krylov method on a backend, in its memory.
struct Scalars {
  enum Name : int {
    rz,  // of conjugate gradients; 0: the first iteration, or the first one under another preconditioner
    curvature,  // pᵀ A p
    rr,
    next_rz,  // of the vector that is preconditioned next: the residual, or the Lanczos vector of MINRES
    beta,
    enough,
    iterations,
    most,
    stopped,
    indefinite,
    unfit  // the preconditioner is not positive definite
  };
  double* values;
  PLIANT_HOST_DEVICE double& operator[](Name name) const { return values[name]; }
};

/// Before r·r.
struct ClearSquare {
  Scalars s;
  PLIANT_HOST_DEVICE void operator()(Index) const { s[Scalars::rr] = 0; }
};
/// Behind r·r.
struct EndIteration {
  Scalars s;
  PLIANT_HOST_DEVICE void operator()(Index) const {
    if (s[Scalars::stopped] != 0) return;
    s[Scalars::iterations] += 1;
    // A residual that is not a number stops too.
    if (!(s[Scalars::rr] > s[Scalars::enough]) || s[Scalars::iterations] >= s[Scalars::most])
      s[Scalars::stopped] = 1;
  }
};

}  // namespace pliant::detail
