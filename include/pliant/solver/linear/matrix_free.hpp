#pragma once

#include <array>
#include <cmath>

#include <pliant/backend/host_recording.hpp>
#include <pliant/body/solver_arrays.hpp>
#include <pliant/solver/linear/krylov_report.hpp>
#include <pliant/solver/linear/shifted_tangent.hpp>

// Conjugate gradients where a body's arrays lie: no host waits inside a run of iterations.
namespace pliant::detail {

/// The numbers of conjugate gradients, in the backend's memory.
struct Scalars {
  enum Name : int {
    rz,
    curvature,
    rr,
    next_rz,
    beta,
    enough,
    iterations,
    most,
    stopped,
    indefinite
  };
  double* values;
  PLIANT_HOST_DEVICE double& operator[](Name name) const { return values[name]; }
};

/// Before an iteration's products.
struct BeginIteration {
  Scalars s;
  PLIANT_HOST_DEVICE void operator()(Index) const { s[Scalars::curvature] = 0; }
};
/// Behind p·A p: stops where the matrix is not positive definite along p.
struct CheckCurvature {
  Scalars s;
  PLIANT_HOST_DEVICE void operator()(Index) const {
    s[Scalars::rr] = s[Scalars::next_rz] = 0;
    if (s[Scalars::stopped] != 0 || (s[Scalars::curvature] > 0 && s[Scalars::rz] > 0)) return;
    s[Scalars::indefinite] = s[Scalars::stopped] = 1;
  }
};
/// Behind the products of the new residual.
struct EndIteration {
  Scalars s;
  PLIANT_HOST_DEVICE void operator()(Index) const {
    if (s[Scalars::stopped] != 0) return;
    s[Scalars::beta] = s[Scalars::next_rz] / s[Scalars::rz];
    s[Scalars::rz] = s[Scalars::next_rz];
    s[Scalars::iterations] += 1;
    // A residual that is not a number stops too.
    if (!(s[Scalars::rr] > s[Scalars::enough]) || s[Scalars::iterations] >= s[Scalars::most])
      s[Scalars::stopped] = 1;
  }
};

/// z = blocks · r at a node.
template <class T, int Dim>
PLIANT_HOST_DEVICE Vector<T, Dim> conditioned_at(NodeField<T const, Dim> const (&columns)[Dim],
                                                 Vector<T, Dim> const& r, Index i) {
  auto z = Vector<T, Dim>::zero();
  for (int k = 0; k < Dim; ++k) z = z + r[k] * columns[k].at(i);
  return z;
}

/// r = b, x = 0, z = blocks · r, p = z.
template <class T, int Dim>
struct BeginGradients {
  NodeField<T, Dim> x, z, p;
  NodeField<T const, Dim> r, columns[Dim];
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto const own = conditioned_at(columns, r.at(i), i);
    x.set(i, Vector<T, Dim>::zero());
    z.set(i, own);
    p.set(i, own);
  }
};
/// x += α p, r −= α q, z = blocks · r with α = rᵀz / pᵀq.
template <class T, int Dim>
struct GoAlong {
  Scalars s;
  NodeField<T, Dim> x, r, z;
  NodeField<T const, Dim> p, q, columns[Dim];
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (s[Scalars::stopped] != 0) return;
    T const alpha = static_cast<T>(s[Scalars::rz] / s[Scalars::curvature]);
    auto const left = r.at(i) - alpha * q.at(i);
    x.set(i, x.at(i) + alpha * p.at(i));
    r.set(i, left);
    z.set(i, conditioned_at(columns, left, i));
  }
};
/// p = z + β p.
template <class T, int Dim>
struct TurnDirection {
  Scalars s;
  NodeField<T, Dim> p;
  NodeField<T const, Dim> z;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (s[Scalars::stopped] == 0) p.set(i, z.at(i) + static_cast<T>(s[Scalars::beta]) * p.at(i));
  }
};

/// Solves A x = b for x in arrays.solution, from 0, until |b − A x| ≤ tolerance |b|: conjugate gradients (Hestenes and
/// Stiefel 1952) under the inverse blocks of the nodes, with sums in double precision. b stands in arrays.residual,
/// zero at what is no unknown, and is lost. On a GPU iterations are recorded and replayed by the stretch; what is
/// behind the last one of a stretch does nothing.
template <class Parts>
KrylovReport solve_matrix_free(Parts& parts, SolverArrays<typename Parts::backend_type>& arrays,
                               ShiftedTangent<Parts> const& a, double tolerance,
                               int max_iterations) {
  using T = typename Parts::T;
  constexpr int dim = Parts::dim, stretch = 8;
  auto const& backend = parts.backend;
  Index const n = parts.layout.nodes;
  auto const x = node_field<dim>(arrays.solution), r = node_field<dim>(arrays.residual),
             p = node_field<dim>(arrays.direction), z = node_field<dim>(arrays.conditioned),
             q = node_field<dim>(arrays.image);
  using Const = NodeField<T const, dim>;
  Scalars const s{arrays.scalars.data()};
  auto const dot_into = [&](Scalars::Name name, auto const& one, auto const& other) {
    backend.add_sum(n, DotAt<T, dim>{{one.data}, {other.data}}, &s[name]);
  };
  auto const with_columns = [&](auto functor) {
    for (int k = 0; k < dim; ++k)
      functor.columns[k] = {ShiftedTangent<Parts>::column(parts, arrays.blocks.data(), k).data};
    return functor;
  };

  a.invert_blocks(parts, arrays.blocks.data(), q);
  backend.for_each(n, with_columns(BeginGradients<T, dim>{x, z, p, Const{r.data}, {}}));
  std::vector<double> values(arrays.scalars.size(), 0.0);
  arrays.scalars.upload(values);
  dot_into(Scalars::rr, r, r);
  dot_into(Scalars::rz, r, z);
  values = download<double>(arrays.scalars);
  KrylovReport report{.residual = std::sqrt(values[Scalars::rr])};
  double const size = values[Scalars::rr];
  if (!(size > 0) || !std::isfinite(size)) {
    report.converged = size == 0;
    return report;
  }
  values[Scalars::enough] = tolerance * tolerance * size;
  values[Scalars::most] = max_iterations;
  arrays.scalars.upload(values);

  auto& kept = arrays.recorded;
  std::array const matrix{a.inertia, a.stiffness, a.damping, static_cast<double>(a.mass)};
  std::array const fields{a.place.data, a.start.data};
  if (!kept || kept->revision != parts.revision || kept->matrix != matrix ||
      kept->fields != fields) {
    auto const step = with_columns(GoAlong<T, dim>{s, x, r, z, Const{p.data}, Const{q.data}, {}});
    // The functors live on in the recording.
    auto const iterate = [&parts, a, backend, n, s, p, q, r, z, step] {
      auto const dot = [&](Scalars::Name name, auto const& one, auto const& other) {
        backend.add_sum(n, DotAt<T, dim>{{one.data}, {other.data}}, &s[name]);
      };
      for (int k = 0; k < stretch; ++k) {
        backend.for_each(1, BeginIteration{s});
        a.apply(parts, p, q);
        dot(Scalars::curvature, p, q);
        backend.for_each(1, CheckCurvature{s});
        backend.for_each(n, step);
        dot(Scalars::rr, r, r);
        dot(Scalars::next_rz, r, z);
        backend.for_each(1, EndIteration{s});
        backend.for_each(n, TurnDirection<T, dim>{s, p, Const{z.data}});
        if constexpr (std::same_as<typename Parts::backend_type::Recording, HostRecording>)
          if (s[Scalars::stopped] != 0) return;
      }
    };
    kept = {backend.record(iterate), parts.revision, matrix, fields};
  }
  do {
    kept->recording.replay(1);
    values = download<double>(arrays.scalars);
  } while (values[Scalars::stopped] == 0);
  report.iterations = static_cast<int>(values[Scalars::iterations]);
  report.residual = std::sqrt(values[Scalars::rr]);
  report.indefinite = values[Scalars::indefinite] != 0;
  report.converged = report.residual <= tolerance * std::sqrt(size);
  parts.layout.interpolation.apply(backend, x);
  return report;
}

}  // namespace pliant::detail
