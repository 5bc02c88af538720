#pragma once

#include <limits>
#include <memory>
#include <vector>

#include <pliant/solver/linear/krylov_fields.hpp>
#include <pliant/solver/linear/minres_numbers.hpp>

// MINRES on a backend: the steps as functors, and the iteration of them.
namespace pliant::detail {

/// p = z / γ.
template <class T, int Dim>
struct ScaleDirection {
  MinresNumbers const* k;
  NodeField<T, Dim> p;
  NodeField<T const, Dim> z;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    p.set(i, static_cast<T>(k->gamma > 0 ? 1 / k->gamma : 0) * z.at(i));
  }
};
/// The next Lanczos vector, q − δ/γ v − γ/γ₋₁ v₋₁, and z = blocks · it where these are all that preconditions.
template <class T, int Dim>
struct NextLanczosVector {
  Scalars s;
  MinresNumbers const* k;
  NodeField<T, Dim> v, v_before, z;
  NodeField<T const, Dim> q, columns[Dim];
  bool conditions;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (s[Scalars::stopped] != 0) return;
    auto const now = v.at(i);
    auto const next = q.at(i) - static_cast<T>(s[Scalars::curvature] / k->gamma) * now -
                      static_cast<T>(k->gamma / k->gamma_before) * v_before.at(i);
    v_before.set(i, now);
    v.set(i, next);
    if (conditions) z.set(i, conditioned_at(columns, next, i));
  }
};
/// Behind v·z.
struct Rotate {
  Scalars s;
  MinresNumbers* k;
  PLIANT_HOST_DEVICE void operator()(Index) const {
    if (s[Scalars::stopped] == 0) {
      k->rotate(s[Scalars::curvature], s[Scalars::next_rz]);
      if (k->indefinite) s[Scalars::indefinite] = 1;
      if (k->state == MinresNumbers::State::unfit) s[Scalars::unfit] = 1;
      if (k->state != MinresNumbers::State::goes_on) s[Scalars::stopped] = 1;
    }
    s[Scalars::curvature] = s[Scalars::next_rz] = s[Scalars::rr] = 0;
  }
};
/// w = (p − α₂ w₋₁ − α₃ w₋₂)/α₁, x and r along it, and the next p.
template <class T, int Dim>
struct GoAlongMinres {
  Scalars s;
  MinresNumbers const* k;
  NodeField<T, Dim> x, r, p, w, w_before;
  NodeField<T const, Dim> z, v;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (s[Scalars::stopped] != 0) return;
    auto const before = w.at(i);
    auto const next =
        static_cast<T>(1 / k->alpha_1) * (p.at(i) - static_cast<T>(k->alpha_2) * before -
                                          static_cast<T>(k->alpha_3) * w_before.at(i));
    w_before.set(i, before);
    w.set(i, next);
    x.set(i, x.at(i) + static_cast<T>(k->ahead) * next);
    r.set(i, static_cast<T>(k->kept) * r.at(i) - static_cast<T>(k->taken) * v.at(i));
    if (k->gamma > 0) p.set(i, static_cast<T>(1 / k->gamma) * z.at(i));
  }
};

/// What MINRES keeps on a backend besides SolverArrays.
template <Backend B>
struct MinresArrays final : KeptBySolver {
  using T = typename B::scalar;
  typename B::template Array<T> v, v_before, w, w_before;  // fields of padded rows, (nodes, 4)
  typename B::template Array<MinresNumbers> numbers;

  MinresArrays(B const& backend, std::size_t rows) : numbers(zeros<MinresNumbers>(backend, 1)) {
    for (auto* array : {&v, &v_before, &w, &w_before}) *array = zeros<T>(backend, rows);
  }
};

/// An iteration of preconditioned MINRES (Paige and Saunders 1975; see MinresNumbers).
template <class Parts>
class MinresIteration {
  using Fields = KrylovFields<Parts>;
  using T = typename Parts::T;
  using Kept = MinresArrays<typename Parts::backend_type>;
  static constexpr int dim = Parts::dim;

 public:
  /// `by`: null where inverse blocks precondition.
  MinresIteration(Fields const& fields, Multigrid<Parts> const* by) : f_(fields), by_(by) {
    auto& kept = f_.arrays().minres;
    if (!kept) kept = std::make_unique<Kept>(f_.backend(), f_.arrays().solution.size());
    kept_ = static_cast<Kept*>(kept.get());
  }
  /// What a recording depends on, besides the matrix.
  KeptBySolver const* kept() const { return kept_; }
  /// Before the first one, or the first one under another preconditioner.
  void begin() const {
    auto const& backend = f_.backend();
    auto const v = field(kept_->v);
    set_sum(backend, f_.n, v, Scaled<T, dim>{1, Fields::fixed(f_.r)});
    for (auto* array : {&kept_->v_before, &kept_->w, &kept_->w_before})
      backend.for_each(f_.n, Clear<T>{array->data()});
    precondition(v);
    double const vz = backend.sum(f_.n, DotAt<T, dim>{Fields::fixed(v), Fields::fixed(f_.z)});
    auto const first = MinresNumbers::first(vz, double{std::numeric_limits<T>::epsilon()});
    kept_->numbers.upload(std::vector{first});
    backend.for_each(f_.n, ScaleDirection<T, dim>{numbers(), f_.p, Fields::fixed(f_.z)});
  }
  void operator()() const {
    auto const& backend = f_.backend();
    auto const v = field(kept_->v), v_before = field(kept_->v_before), w = field(kept_->w),
               w_before = field(kept_->w_before);
    f_.multiply();
    f_.dot_into(Scalars::curvature, f_.p, f_.q);
    backend.for_each(f_.n, f_.with_columns(NextLanczosVector<T, dim>{
                               f_.s, numbers(), v, v_before, f_.z, Fields::fixed(f_.q), {}, !by_}));
    if (by_) f_.precondition(*by_, v);
    f_.dot_into(Scalars::next_rz, v, f_.z);
    backend.for_each(1, Rotate{f_.s, numbers()});
    backend.for_each(f_.n, GoAlongMinres<T, dim>{f_.s, numbers(), f_.x, f_.r, f_.p, w, w_before,
                                                 Fields::fixed(f_.z), Fields::fixed(v)});
    f_.dot_into(Scalars::rr, f_.r, f_.r);
    backend.for_each(1, EndIteration{f_.s});
  }

 private:
  using Field = typename Fields::Field;
  static Field field(typename Fields::Arrays::template Array<T>& array) { return {array.data()}; }
  MinresNumbers* numbers() const { return kept_->numbers.data(); }
  void precondition(Field from) const {
    if (by_)
      f_.precondition(*by_, from);
    else
      f_.precondition_by_blocks(from);
  }

  Fields f_;
  Multigrid<Parts> const* by_;
  Kept* kept_;
};

}  // namespace pliant::detail
