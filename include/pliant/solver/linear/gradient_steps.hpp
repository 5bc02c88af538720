#pragma once

#include <pliant/solver/linear/krylov_fields.hpp>

// Conjugate gradients on a backend: the steps as functors, and the iteration of them.
namespace pliant::detail {

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
/// An iteration of preconditioned conjugate gradients (Hestenes and Stiefel 1952).
template <class Parts>
class GradientIteration {
  using Fields = KrylovFields<Parts>;
  using T = typename Parts::T;
  static constexpr int dim = Parts::dim;

 public:
  /// `by`: null where inverse blocks precondition.
  GradientIteration(Fields const& fields, Multigrid<Parts> const* by) : f_(fields), by_(by) {}

  /// What a recording depends on, besides the matrix.
  KeptBySolver const* kept() const { return nullptr; }
  /// Before the first one, or the first one under another preconditioner.
  void begin() const {
    if (!by_) f_.precondition_by_blocks(f_.r);
  }
  void operator()() const {
    auto const& backend = f_.backend();
    if (by_) f_.precondition(*by_, f_.r);
    f_.dot_into(Scalars::next_rz, f_.r, f_.z);
    backend.for_each(1, BeginIteration{f_.s});
    backend.for_each(f_.n, TurnDirection<T, dim>{f_.s, f_.p, Fields::fixed(f_.z)});
    f_.multiply();
    f_.dot_into(Scalars::curvature, f_.p, f_.q);
    backend.for_each(1, CheckCurvature{f_.s});
    backend.for_each(
        f_.n, f_.with_columns(GoAlong<T, dim>{
                  f_.s, f_.x, f_.r, f_.z, Fields::fixed(f_.p), Fields::fixed(f_.q), {}, !by_}));
    f_.dot_into(Scalars::rr, f_.r, f_.r);
    backend.for_each(1, EndIteration{f_.s});
  }

 private:
  Fields f_;
  Multigrid<Parts> const* by_;
};

}  // namespace pliant::detail
