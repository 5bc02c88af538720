#pragma once

#include <pliant/quadrature/quadrature.hpp>

// Gauss rules on a line from the zeros of Jacobi polynomials, computed by the compiler.
namespace pliant::detail {

/// P_n^(α, β)(x) and its derivative, by the three-term recurrence (Abramowitz and Stegun, 22.7).
struct JacobiPolynomial {
  int n, alpha, beta;
  struct Value {
    double value, slope;
  };
  PLIANT_HOST_DEVICE constexpr Value operator()(double x) const {
    Value before{1, 0},
        now{(alpha + 1) + (alpha + beta + 2) * (x - 1) / 2, (alpha + beta + 2) / 2.0};
    if (n == 0) return before;
    for (int k = 1; k < n; ++k) {
      double const s = 2 * k + alpha + beta;
      double const a = 2 * (k + 1) * (k + alpha + beta + 1) * s;
      double const b = (s + 1) * (alpha * alpha - beta * beta), c = s * (s + 1) * (s + 2);
      double const d = 2 * (k + alpha) * (k + beta) * (s + 2);
      Value const next{((b + c * x) * now.value - d * before.value) / a,
                       (c * now.value + (b + c * x) * now.slope - d * before.slope) / a};
      before = now;
      now = next;
    }
    return now;
  }
};

/// The zeros, ascending: Newton's method from the right, each zero found divided out.
template <int N>
PLIANT_HOST_DEVICE constexpr Vector<double, N> zeros(JacobiPolynomial const& p) {
  Vector<double, N> found{};
  for (int i = N - 1; i >= 0; --i) {
    double x = 1;
    for (int step = 0; step < 60; ++step) {
      auto const [value, slope] = p(x);
      double others = 0;
      for (int j = i + 1; j < N; ++j) others += 1 / (x - found[j]);
      double const change = value / (slope - value * others);
      x -= change;
      if (change * change < 1e-34) break;
    }
    found[i] = x;
  }
  if (p.alpha == p.beta)  // symmetric to the last bit
    for (int i = 0; i < N / 2; ++i) found[i] = -found[N - 1 - i];
  if (p.alpha == p.beta && N % 2 == 1) found[N / 2] = 0;
  return found;
}

/// N points for ∫ (1 − x)^α f dx over [−1, 1], exact to degree 2N − 1.
template <int N, int Alpha = 0>
PLIANT_HOST_DEVICE constexpr QuadratureRule<1, N> gauss_jacobi() {
  static_assert(N >= 1 && N <= 10, "Gauss<n> has 1 to 10 points per direction");
  constexpr JacobiPolynomial p{N, Alpha, 0};
  constexpr auto x = zeros<N>(p);
  QuadratureRule<1, N> rule{};
  for (int i = 0; i < N; ++i) {
    double const slope = p(x[i]).slope;
    rule.points[i][0] = x[i];
    rule.weights[i] = (2 << Alpha) / ((1 - x[i] * x[i]) * slope * slope);
  }
  return rule;
}

/// N points, both ends among them, exact to degree 2N − 3 (Abramowitz and Stegun, 25.4.32).
template <int N>
PLIANT_HOST_DEVICE constexpr QuadratureRule<1, N> gauss_lobatto() {
  static_assert(N >= 2 && N <= 10, "Lobatto<n> has 2 to 10 points per direction");
  constexpr int between = N > 2 ? N - 2 : 1;  // where N is 2, unused
  constexpr auto inner = zeros<between>({between, 1, 1});
  constexpr JacobiPolynomial legendre{N - 1, 0, 0};
  QuadratureRule<1, N> rule{};
  for (int i = 0; i < N; ++i) {
    double const x = i == 0 ? -1 : i == N - 1 ? 1 : inner[i - 1];
    double const value = legendre(x).value;
    rule.points[i][0] = x;
    rule.weights[i] = 2 / (N * (N - 1) * value * value);
  }
  return rule;
}

/// The same rule in each direction of [−1, 1]ᵈ; direction 0 runs fastest.
template <int Dim, int N>
PLIANT_HOST_DEVICE constexpr auto tensor_product(QuadratureRule<1, N> const& line) {
  constexpr int count = Dim == 1 ? N : Dim == 2 ? N * N : N * N * N;
  QuadratureRule<Dim, count> rule{};
  for (int q = 0; q < count; ++q) {
    rule.weights[q] = 1;
    for (int k = 0, rest = q; k < Dim; ++k, rest /= N) {
      rule.points[q][k] = line.points[rest % N][0];
      rule.weights[q] *= line.weights[rest % N];
    }
  }
  return rule;
}

/// A rule on triangles times one along the axis.
template <int M, int N>
PLIANT_HOST_DEVICE constexpr auto on_wedge(QuadratureRule<2, M> const& triangle,
                                           QuadratureRule<1, N> const& line) {
  QuadratureRule<3, M * N> rule{};
  for (int q = 0; q < M * N; ++q) {
    rule.points[q][0] = triangle.points[q % M][0];
    rule.points[q][1] = triangle.points[q % M][1];
    rule.points[q][2] = line.points[q / M][0];
    rule.weights[q] = triangle.weights[q % M] * line.weights[q / M];
  }
  return rule;
}

/// Layers of the square, shrinking towards the apex as (1 − ζ)² dζ asks (conical product).
template <int N>
PLIANT_HOST_DEVICE constexpr auto on_pyramid() {
  constexpr auto square = tensor_product<2>(gauss_jacobi<N>());
  constexpr auto axis = gauss_jacobi<N, 2>();
  QuadratureRule<3, N * N * N> rule{};
  for (int q = 0; q < N * N * N; ++q) {
    double const left = (1 - axis.points[q / (N * N)][0]) / 2;
    rule.points[q][0] = left * square.points[q % (N * N)][0];
    rule.points[q][1] = left * square.points[q % (N * N)][1];
    rule.points[q][2] = 1 - left;
    rule.weights[q] = square.weights[q % (N * N)] * axis.weights[q / (N * N)] / 8;
  }
  return rule;
}

}  // namespace pliant::detail
