#pragma once

#include <array>
#include <cmath>
#include <limits>

#include <pliant/backend/host_recording.hpp>
#include <pliant/solver/linear/gradient_steps.hpp>
#include <pliant/solver/linear/krylov_method.hpp>
#include <pliant/solver/linear/krylov_report.hpp>
#include <pliant/solver/linear/minres_steps.hpp>
#include <pliant/solver/linear/preconditioning.hpp>

// Krylov methods where a body's arrays lie: no host waits inside a run of iterations.
namespace pliant::detail {

/// A x = b for x in arrays.solution, from 0, with b in arrays.residual, by the iterations of one method behind another.
template <class Parts>
class MatrixFreeSystem {
  using T = typename Parts::T;
  static constexpr int dim = Parts::dim;
  using Arrays = SolverArrays<typename Parts::backend_type>;

 public:
  MatrixFreeSystem(Parts& parts, Arrays& arrays, ShiftedTangent<Parts> const& a, double tolerance,
                   int max_iterations, Preconditioning<Parts>& by)
      : parts_(parts),
        arrays_(arrays),
        fields_(parts, arrays, a),
        tolerance_(tolerance),
        by_(by),
        values_(arrays.scalars.size(), 0.0) {
    parts.backend.for_each(fields_.n, Clear<T>{fields_.x.data});
    arrays.scalars.upload(values_);
    fields_.keep_right_hand_side();
    fields_.dot_into(Scalars::rr, fields_.r, fields_.r);
    values_ = download<double>(arrays.scalars);
    size_ = values_[Scalars::rr];
    values_[Scalars::enough] = tolerance * tolerance * size_;
    values_[Scalars::most] = max_iterations;
    if (is_regular()) by.begin(parts, arrays, a);
  }
  /// Whether b is finite, and not zero.
  bool is_regular() const { return size_ > 0 && std::isfinite(size_); }
  /// Whether x stayed 0.
  bool ended_at_once() const { return values_[Scalars::iterations] == 0; }

  /// Until |b − A x| ≤ tolerance |b|, computed from x: a recursion does not know how x was rounded. It begins again with what
  /// is left, as long as that halves it.
  template <template <class> class Iteration>
  void iterate() {
    for (double before = std::numeric_limits<double>::infinity();;) {
      run<Iteration>();
      bool const claims = values_[Scalars::rr] <= values_[Scalars::enough];
      fields_.find_residual();
      values_ = download<double>(arrays_.scalars);
      double const left = values_[Scalars::rr];
      if (!claims || left <= values_[Scalars::enough] || !(left < before / 4) ||
          values_[Scalars::iterations] >= values_[Scalars::most])
        return;
      before = left;
    }
  }
  /// |b − A x| / |b|.
  double share() const { return std::sqrt(values_[Scalars::rr] / size_); }
  KrylovReport report() const {
    return {static_cast<int>(values_[Scalars::iterations]), std::sqrt(values_[Scalars::rr]),
            values_[Scalars::rr] <= values_[Scalars::enough],
            values_[Scalars::indefinite] != 0 || values_[Scalars::unfit] != 0};
  }

 private:
  /// From the x so far, until the recursion claims that |b − A x| ≤ tolerance |b|. On a GPU iterations are recorded and replayed by the stretch; what
  /// is behind the last one of a stretch does nothing. Another preconditioner goes on from the x of the one before.
  template <template <class> class Iteration>
  void run() {
    auto& a = fields_.a;
    begin<Iteration>();
    for (;;) {
      arrays_.recorded->recording.replay(1);
      values_ = download<double>(arrays_.scalars);
      if (values_[Scalars::stopped] == 0) {
        if (!by_.should_turn_to_multigrid(parts_, static_cast<int>(values_[Scalars::iterations]),
                                          share(), tolerance_))
          continue;
        by_.turn_to_multigrid(parts_, arrays_, a);
      } else if (values_[Scalars::unfit] == 0 || !by_.replace(parts_, arrays_, a)) {
        return;
      }
      begin<Iteration>();
    }
  }
  template <template <class> class Iteration>
  void begin() {
    Multigrid<Parts> const* const condition = by_.in(arrays_);
    Iteration<Parts> const iteration(fields_, condition);
    iteration.begin();
    values_[Scalars::rz] = values_[Scalars::next_rz] = values_[Scalars::curvature] = 0;
    values_[Scalars::stopped] = values_[Scalars::unfit] = 0;
    arrays_.scalars.upload(values_);

    auto& kept = arrays_.recorded;
    auto const& a = fields_.a;
    std::array const matrix{a.inertia, a.stiffness, a.damping, static_cast<double>(a.mass)};
    std::array const places{a.place.data, a.start.data};
    if (kept && kept->revision == parts_.revision && kept->matrix == matrix &&
        kept->fields == places && kept->preconditioner == condition &&
        kept->method == iteration.kept())
      return;
    // The functors live on in the recording.
    auto const stretch = [iteration, s = fields_.s, long_ones = condition != nullptr] {
      // A stretch of long iterations is one of them: those behind the last one cost more than a look at it.
      for (int k = 0; k < (long_ones ? 1 : 8); ++k) {
        iteration();
        if constexpr (std::same_as<typename Parts::backend_type::Recording, HostRecording>)
          if (s[Scalars::stopped] != 0) return;
      }
    };
    kept = {parts_.backend.record(stretch),
            parts_.revision,
            matrix,
            places,
            condition,
            iteration.kept()};
  }

  Parts& parts_;
  Arrays& arrays_;
  KrylovFields<Parts> fields_;
  double tolerance_, size_ = 0;  // |b|²
  Preconditioning<Parts>& by_;
  std::vector<double> values_;
};

/// Solves A x = b for x in arrays.solution, from 0, until |b − A x| ≤ tolerance |b|, with sums in double precision, by
/// conjugate gradients or MINRES, preconditioned. b stands in arrays.residual, zero at what is no unknown, and is lost.
/// It has converged where b − A x, computed from x, is that small. Automatic: MINRES solves it where the first direction of
/// conjugate gradients has no positive curvature.
template <class Parts>
KrylovReport solve_matrix_free(Parts& parts, SolverArrays<typename Parts::backend_type>& arrays,
                               ShiftedTangent<Parts> const& a, double tolerance, int max_iterations,
                               Preconditioning<Parts>& by,
                               KrylovMethod method = KrylovMethod::conjugate_gradients) {
  MatrixFreeSystem<Parts> system(parts, arrays, a, tolerance, max_iterations, by);
  if (!system.is_regular()) return system.report();
  if (method != KrylovMethod::minres) system.template iterate<GradientIteration>();
  bool const has_no_way = method == KrylovMethod::automatic && system.ended_at_once();
  if (method == KrylovMethod::minres || has_no_way) {
    by.note_minres();
    system.template iterate<MinresIteration>();
  }
  auto const report = system.report();
  by.end(report.iterations, system.share());
  parts.layout.interpolation.apply(parts.backend, node_field<Parts::dim>(arrays.solution));
  return report;
}

}  // namespace pliant::detail
