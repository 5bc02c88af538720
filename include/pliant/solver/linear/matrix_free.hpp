#pragma once

#include <array>
#include <cmath>

#include <pliant/backend/host_recording.hpp>
#include <pliant/body/solver_arrays.hpp>
#include <pliant/solver/linear/gradient_steps.hpp>
#include <pliant/solver/linear/krylov_report.hpp>
#include <pliant/solver/linear/preconditioning.hpp>

// Conjugate gradients where a body's arrays lie: no host waits inside a run of iterations.
namespace pliant::detail {

/// Solves A x = b for x in arrays.solution, from 0, until |b − A x| ≤ tolerance |b|: preconditioned conjugate gradients
/// (Hestenes and Stiefel 1952), with sums in double precision. b stands in arrays.residual, zero at what is no unknown,
/// and is lost. On a GPU iterations are recorded and replayed by the stretch; what is behind the last one of a stretch
/// does nothing. Another preconditioner goes on from the x of the one before.
template <class Parts>
KrylovReport solve_matrix_free(Parts& parts, SolverArrays<typename Parts::backend_type>& arrays,
                               ShiftedTangent<Parts> const& a, double tolerance, int max_iterations,
                               Preconditioning<Parts>& by) {
  using T = typename Parts::T;
  constexpr int dim = Parts::dim;
  auto const& backend = parts.backend;
  Index const n = parts.layout.nodes;
  auto const x = node_field<dim>(arrays.solution), r = node_field<dim>(arrays.residual),
             p = node_field<dim>(arrays.direction), z = node_field<dim>(arrays.conditioned),
             q = node_field<dim>(arrays.image);
  using Const = NodeField<T const, dim>;
  using Dot = DotAt<T, dim>;
  Scalars const s{arrays.scalars.data()};
  auto const dot_into = [=](Scalars::Name name, auto const& one, auto const& other) {
    backend.add_sum(n, Dot{{one.data}, {other.data}}, &s[name]);
  };
  auto const with_columns = [&](auto functor) {
    for (int k = 0; k < dim; ++k)
      functor.columns[k] = {ShiftedTangent<Parts>::column(parts, arrays.blocks.data(), k).data};
    return functor;
  };

  backend.for_each(n, Clear<T>{x.data});
  std::vector<double> values(arrays.scalars.size(), 0.0);
  arrays.scalars.upload(values);
  dot_into(Scalars::rr, r, r);
  values = download<double>(arrays.scalars);
  KrylovReport report{.residual = std::sqrt(values[Scalars::rr])};
  double const size = values[Scalars::rr];
  if (!(size > 0) || !std::isfinite(size)) {
    report.converged = size == 0;
    return report;
  }
  values[Scalars::enough] = tolerance * tolerance * size;
  values[Scalars::most] = max_iterations;

  auto const record = [&] {
    auto& kept = arrays.recorded;
    std::array const matrix{a.inertia, a.stiffness, a.damping, static_cast<double>(a.mass)};
    std::array const fields{a.place.data, a.start.data};
    Multigrid<Parts> const* const condition = by.in(arrays);
    if (kept && kept->revision == parts.revision && kept->matrix == matrix &&
        kept->fields == fields && kept->preconditioner == condition)
      return;
    auto const step =
        with_columns(GoAlong<T, dim>{s, x, r, z, Const{p.data}, Const{q.data}, {}, !condition});
    TurnDirection<T, dim> const turn{s, p, Const{z.data}};
    // The functors live on in the recording.
    auto const iterate = [&parts, &arrays, a, backend, n, s, p, q, r, z, step, turn, condition,
                          dot_into] {
      // A stretch of long iterations is one of them: those behind the last one cost more than a look at it.
      for (int k = 0; k < (condition ? 1 : 8); ++k) {
        if (condition) condition->apply(parts, arrays, a);
        dot_into(Scalars::next_rz, r, z);
        backend.for_each(1, BeginIteration{s});
        backend.for_each(n, turn);
        a.apply(parts, p, q);
        dot_into(Scalars::curvature, p, q);
        backend.for_each(1, CheckCurvature{s});
        backend.for_each(n, step);
        dot_into(Scalars::rr, r, r);
        backend.for_each(1, EndIteration{s});
        if constexpr (std::same_as<typename Parts::backend_type::Recording, HostRecording>)
          if (s[Scalars::stopped] != 0) return;
      }
    };
    kept = {backend.record(iterate), parts.revision, matrix, fields, condition};
  };
  auto const begin = [&] {
    if (by.is_nodal()) backend.for_each(n, with_columns(ConditionAt<T, dim>{z, Const{r.data}, {}}));
    values[Scalars::rz] = values[Scalars::next_rz] = values[Scalars::curvature] = 0;
    values[Scalars::stopped] = values[Scalars::unfit] = 0;
    arrays.scalars.upload(values);
    record();
  };

  by.begin(parts, arrays, a);
  begin();
  for (;;) {
    arrays.recorded->recording.replay(1);
    values = download<double>(arrays.scalars);
    auto const iterations = static_cast<int>(values[Scalars::iterations]);
    if (values[Scalars::stopped] == 0) {
      if (!by.should_turn_to_multigrid(parts, iterations, std::sqrt(values[Scalars::rr] / size),
                                       tolerance))
        continue;
      by.turn_to_multigrid(parts, arrays, a);
    } else if (values[Scalars::unfit] == 0 || !by.replace(parts, arrays, a)) {
      break;
    }
    begin();
  }
  report.iterations = static_cast<int>(values[Scalars::iterations]);
  report.residual = std::sqrt(values[Scalars::rr]);
  report.indefinite = values[Scalars::indefinite] != 0 || values[Scalars::unfit] != 0;
  report.converged = report.residual <= tolerance * std::sqrt(size);
  by.end(report.iterations, report.residual / std::sqrt(size));
  parts.layout.interpolation.apply(backend, x);
  return report;
}

}  // namespace pliant::detail
