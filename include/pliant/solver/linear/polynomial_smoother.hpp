#pragma once

#include <cstdint>

#include <pliant/backend/backend.hpp>
#include <pliant/solver/linear/lanczos_matrix.hpp>
#include <pliant/solver/linear/node_sums.hpp>

// Chebyshev's polynomials of D⁻¹ A on a backend, where D are the blocks of the diagonal, a node each.
namespace pliant::detail {

/// z = D⁻¹ r at a node, where columns are those of the inverse blocks.
template <class T, int Dim>
PLIANT_HOST_DEVICE Vector<T, Dim> conditioned_at(NodeField<T const, Dim> const (&columns)[Dim],
                                                 Vector<T, Dim> const& r, Index i) {
  auto z = Vector<T, Dim>::zero();
  for (int k = 0; k < Dim; ++k) z = z + r[k] * columns[k].at(i);
  return z;
}

/// d = keep · d + take/λ · D⁻¹ (b − q), x += d with q = A x. λ is the largest eigenvalue of D⁻¹ A.
template <class T, int Dim>
struct SmoothingStep {
  NodeField<T, Dim> x, d;
  NodeField<T const, Dim> b, q, columns[Dim];
  T const* per_largest;  // 1/λ
  T keep, take;
  bool from_zero;  // x counts as zero, and q is not there
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto r = b.at(i);
    if (!from_zero) r = r - q.at(i);
    auto step = (take * *per_largest) * conditioned_at(columns, r, i);
    if (keep != T(0)) step = step + keep * d.at(i);
    d.set(i, step);
    x.set(i, from_zero ? step : x.at(i) + step);
  }
};

/// The steps of a polynomial.
struct SmoothingPolynomial {
  static constexpr int most = 8;
  int degree = 0;
  double keep[most]{}, take[most]{};

  /// For V-cycles, of degree two: Chebyshev's polynomial of the fourth kind with the weights 1.024 and 1.264 that are best
  /// there (Lottes, Numerical Linear Algebra with Applications 30 (2023) e2518, table 1), written as two steps. It needs no
  /// lower end of what it is to make small.
  static constexpr SmoothingPolynomial of_fourth_kind() {
    constexpr double first = 1.02387287570313, second = 1.26408905371085;
    return {2, {0, first + second / 5 - 1}, {4.0 / 3, second * 12 / 5}};
  }
  /// The same without weights, of any degree.
  static constexpr SmoothingPolynomial of_fourth_kind(int degree) {
    SmoothingPolynomial p{degree};
    for (int k = 0; k < degree; ++k) {
      p.keep[k] = k == 0 ? 0 : (2.0 * k - 1) / (2 * k + 3);
      p.take[k] = (8.0 * k + 4) / (2 * k + 3);
    }
    return p;
  }
  /// Makes errors small over [λ/ratio, λ] (Adams, Brezina, Hu, Tuminaro, Parallel multigrid smoothing, 2003).
  static constexpr SmoothingPolynomial of_first_kind(int degree, double ratio) {
    SmoothingPolynomial p{degree};
    double const middle = (1 + 1 / ratio) / 2, half = (1 - 1 / ratio) / 2;
    double rho = half / middle;
    p.take[0] = 1 / middle;
    for (int k = 1; k < degree; ++k) {
      double const next = 1 / (2 * middle / half - rho);
      p.keep[k] = next * rho;
      p.take[k] = 2 * next / half;
      rho = next;
    }
    return p;
  }
};

/// What a smoother works on: fields over n nodes.
template <class T, int Dim>
struct SmootherFields {
  Index n;
  NodeField<T, Dim> b, x, d, q;
  NodeField<T const, Dim> columns[Dim];
  T const* per_largest;
};
enum class Guess { zero, given };

/// x towards A x = b; multiply(x, q) is q = A x.
template <class B, class T, int Dim, class Multiply>
void smooth(B const& backend, SmootherFields<T, Dim> const& f, SmoothingPolynomial const& p,
            Guess guess, Multiply const& multiply) {
  SmoothingStep<T, Dim> step{f.x, f.d, {f.b.data}, {f.q.data}, {}, f.per_largest, 0, 0, false};
  for (int k = 0; k < Dim; ++k) step.columns[k] = f.columns[k];
  for (int k = 0; k < p.degree; ++k) {
    step.from_zero = guess == Guess::zero && k == 0;
    if (!step.from_zero) multiply(f.x, f.q);
    step.keep = static_cast<T>(p.keep[k]);
    step.take = static_cast<T>(p.take[k]);
    backend.for_each(f.n, step);
  }
}

/// x = V(b), symmetric: smoothed before and behind correct(), which adds to x what coarser functions find from b and q = A x.
template <class B, class T, int Dim, class Multiply, class Correct>
void cycle_around(B const& backend, SmootherFields<T, Dim> const& f, SmoothingPolynomial const& p,
                  Multiply const& multiply, Correct const& correct) {
  smooth(backend, f, p, Guess::zero, multiply);
  multiply(f.x, f.q);
  correct();
  smooth(backend, f, p, Guess::given, multiply);
}

/// Any numbers between −1/2 and 1/2, the same ones each time (Steele, Lea, Flood, Fast splittable pseudorandom number
/// generators, 2014).
template <class T, int Dim>
struct SetRandom {
  NodeField<T, Dim> field;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Vector<T, Dim> value;
    for (int k = 0; k < Dim; ++k) {
      auto x = static_cast<std::uint64_t>(Dim * std::int64_t{i} + k + 1) * 0x9e3779b97f4a7c15u;
      x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
      x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
      value[k] = static_cast<T>(x >> 40) / T(1 << 24) - T(0.5);
    }
    field.set(i, value);
  }
};
/// z = D⁻¹ r.
template <class T, int Dim>
struct ConditionAt {
  NodeField<T, Dim> z;
  NodeField<T const, Dim> r, columns[Dim];
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    z.set(i, conditioned_at(columns, r.at(i), i));
  }
};

/// The largest eigenvalue of D⁻¹ A, from below and closely. All fields but the columns are lost.
template <class B, class T, int Dim, class Multiply>
double largest_eigenvalue_on(B const& backend, SmootherFields<T, Dim> const& f,
                             Multiply const& multiply, int steps = 12) {
  auto const r = f.b, z = f.x, p = f.d, q = f.q;
  using Const = NodeField<T const, Dim>;
  backend.for_each(f.n, SetRandom<T, Dim>{r});
  ConditionAt<T, Dim> condition{z, Const{r.data}, {}};
  for (int k = 0; k < Dim; ++k) condition.columns[k] = f.columns[k];
  LanczosMatrix lanczos;
  double rz = 0;
  for (int step = 0; step < steps; ++step) {
    backend.for_each(f.n, condition);
    double const before = rz;
    rz = backend.sum(f.n, DotAt<T, Dim>{{r.data}, {z.data}});
    if (!(rz > 0)) break;
    double const beta = step == 0 ? 0 : rz / before;
    set_sum(backend, f.n, p, Scaled<T, Dim>{1, {z.data}}, Scaled<T, Dim>{beta, {p.data}});
    multiply(p, q);
    double const alpha = rz / backend.sum(f.n, DotAt<T, Dim>{{p.data}, {q.data}});
    if (!lanczos.add(alpha, beta)) break;
    set_sum(backend, f.n, r, Scaled<T, Dim>{1, {r.data}}, Scaled<T, Dim>{-alpha, {q.data}});
  }
  return lanczos.largest();
}

}  // namespace pliant::detail
