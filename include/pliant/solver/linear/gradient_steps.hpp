#pragma once

#include <pliant/solver/linear/polynomial_smoother.hpp>

// The steps of conjugate gradients on a backend, as functors, with the numbers that they share.
namespace pliant::detail {

/// The numbers of conjugate gradients, in the backend's memory.
struct Scalars {
  enum Name : int {
    rz,  // 0: the first iteration, or the first one under another preconditioner
    curvature,
    rr,
    next_rz,
    beta,
    enough,
    iterations,
    most,
    stopped,
    indefinite,
    unfit
  };
  double* values;
  PLIANT_HOST_DEVICE double& operator[](Name name) const { return values[name]; }
};

/// Behind r·z: stops where the preconditioner is not positive definite along r.
struct BeginIteration {
  Scalars s;
  PLIANT_HOST_DEVICE void operator()(Index) const {
    s[Scalars::curvature] = 0;
    if (s[Scalars::stopped] != 0) return;
    if (!(s[Scalars::next_rz] > 0)) {
      s[Scalars::unfit] = s[Scalars::stopped] = 1;
      return;
    }
    s[Scalars::beta] = s[Scalars::rz] > 0 ? s[Scalars::next_rz] / s[Scalars::rz] : 0;
    s[Scalars::rz] = s[Scalars::next_rz];
  }
};
/// p = z + β p.
template <class T, int Dim>
struct TurnDirection {
  Scalars s;
  NodeField<T, Dim> p;
  NodeField<T const, Dim> z;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (s[Scalars::stopped] != 0) return;
    auto next = z.at(i);
    if (s[Scalars::beta] != 0) next = next + static_cast<T>(s[Scalars::beta]) * p.at(i);
    p.set(i, next);
  }
};
/// Behind p·A p: stops where the matrix is not positive definite along p.
struct CheckCurvature {
  Scalars s;
  PLIANT_HOST_DEVICE void operator()(Index) const {
    s[Scalars::rr] = s[Scalars::next_rz] = 0;
    if (s[Scalars::stopped] != 0) return;
    if (!(s[Scalars::curvature] > 0)) s[Scalars::indefinite] = s[Scalars::stopped] = 1;
  }
};
/// x += α p, r −= α q with α = rᵀz / pᵀq, and z = blocks · r where these are all that preconditions.
template <class T, int Dim>
struct GoAlong {
  Scalars s;
  NodeField<T, Dim> x, r, z;
  NodeField<T const, Dim> p, q, columns[Dim];
  bool conditions;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (s[Scalars::stopped] != 0) return;
    T const alpha = static_cast<T>(s[Scalars::rz] / s[Scalars::curvature]);
    auto const left = r.at(i) - alpha * q.at(i);
    x.set(i, x.at(i) + alpha * p.at(i));
    r.set(i, left);
    if (conditions) z.set(i, conditioned_at(columns, left, i));
  }
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
