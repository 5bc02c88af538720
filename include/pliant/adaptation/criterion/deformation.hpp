#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <pliant/adaptation/criterion/element_state.hpp>
#include <pliant/adaptation/criterion/unit.hpp>

// How far an element is from its rest shape.
namespace pliant {

/// R_L = max_k |l_k/L_k − 1| over the edges (Caillaud et al. 2013).
struct EdgeLengthRatio {
  static constexpr Unit unit = Unit::one;

  /// ||F e| − 1| ≤ |H e| for a unit vector e.
  static double least_gradient(double threshold, int) { return threshold; }
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    // l/L − 1 grows with s = l²/L² − 1, so the roots are taken of the extremes alone.
    S longest(0), shortest(0);
    for (int k = 0; k < State::edge_count; ++k) {
      auto const edge = e.edge(k);
      S const s = edge.squared_change / edge.squared_rest;
      longest = maximum(longest, s);
      shortest = minimum(shortest, s);
    }
    auto const ratio = [](S const& s)
                           PLIANT_INLINE { return s / (S(1) + sqrt(max(S(0), S(1) + s))); };
    return maximum(ratio(longest), -ratio(shortest));
  }
};

/// R_A = |A/A₀ − 1|, of the volume in 3D (Caillaud et al. 2013). Under Hooke's zero-strain motion
/// F = I + W it is tan² θ; under a true rotation it is zero.
struct AreaRatio {
  static constexpr Unit unit = Unit::one;

  /// |det(I + H) − 1| ≤ (1 + |H|)^dim − 1, by Hadamard's inequality.
  static double least_gradient(double threshold, int dim) {
    return std::pow(1 + std::max(threshold, 0.0), 1.0 / dim) - 1;
  }
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using E = typename State::element;
    using S = typename State::scalar;
    using T = builtin_scalar<S>;
    // One point integrates the area of a bilinear quadrilateral, two per direction the volume of a
    // trilinear hexahedron.
    constexpr bool one_point = E::degree == 1 && (State::dim == 2 || LinearSimplex<E>);
    using Q = std::conditional_t<one_point, Gauss<1>, Gauss<E::degree + 1>>;
    static constexpr auto table = tabulate<E, Q, T>();
    auto const x = Coefficients<E, S>::of(e.rest), v = Coefficients<E, S>::of(e.u);
    S change(0), volume(0);
    for (int q = 0; q < table.count; ++q) {
      auto const map = RestMap<E, S>::at(x, table, q);
      S const share = map.volume * T(table.weight[q]);
      auto const h = map.gradient(v, table, q);
      change = change + share * determinant_less_one(h);
      volume = volume + share;
    }
    return abs(change / volume);
  }
};

/// How far the element has turned: 2 sin(θ/2) of the rotation R = F (FᵀF)^(−1/2) in the middle of the
/// cell, which is the angle in radians to 0.4% up to 0.3, and √2 at a right angle.
struct Rotation {
  static constexpr Unit unit = Unit::one;

  /// R is the rotation next to F: √2 · value = |R − I| ≤ |R − F| + |F − I| ≤ 2 |H|; where F inverts, |H| ≥ 1.
  static double least_gradient(double threshold, int) {
    return std::min(threshold / std::numbers::sqrt2, 1.0);
  }
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    auto const h = e.gradient();
    if constexpr (State::dim == 2) {
      S const sine = h(1, 0) - h(0, 1), cosine = S(2) + h(0, 0) + h(1, 1);
      S const squared = sine * sine;
      return chord(squared, cosine, sqrt(squared + cosine * cosine));
    } else {
      auto const [r, scale] = scaled_rotation(h);
      S const x = r(2, 1) - r(1, 2), y = r(0, 2) - r(2, 0), z = r(1, 0) - r(0, 1);
      return chord(x * x + y * y + z * z, trace(r) - scale, S(2) * scale);
    }
  }

 private:
  template <class S>
  struct Scaled {
    Tensor<S, 3> rotation;
    S scale;
  };
  /// R of F = I + H, times i₁ i₂ − i₃, from the invariants i_k of U = R⁻¹F (as Hoger & Carlson 1984):
  /// the characteristic polynomial of U, multiplied by R and by R U⁻¹, gives
  /// R (i₁ i₂ − i₃) = i₁ cof F + (i₁² − i₂) F − F FᵀF.
  template <class S>
  PLIANT_HOST_DEVICE static Scaled<S> scaled_rotation(Tensor<S, 3> const& h) {
    auto f = h;
    for (int i = 0; i < 3; ++i) f(i, i) = f(i, i) + S(1);
    auto const c = cofactor(f);
    S const j = f(0, 0) * c(0, 0) + f(0, 1) * c(0, 1) + f(0, 2) * c(0, 2);
    // Where F inverts, its polar factor is that of −F, negated.
    S const sign = select(j < S(0), S(-1), S(1)), i3 = sign * j;
    S const squared = dot(f, f), squared_cofactors = dot(c, c);
    // i₁ is the largest root of (x² − F:F)² − 4 cof F:cof F − 8 i₃ x. Householder's iteration of
    // fourth order, from √(3 F:F) above it: from stretches in [1/2, 2] two steps reach 1.4e-8 of it
    // and three the accuracy of double. Few long steps, because each waits for a division.
    constexpr int steps = sizeof(builtin_scalar<S>) == 4 ? 2 : 3;
    S const constant = S(4) * squared_cofactors, linear = S(8) * i3;
    S x = sqrt(S(3) * squared);
    for (int k = 0; k < steps; ++k) {
      S const d = x * x - squared;
      S const value = d * d - constant - linear * x, slope = S(4) * x * d - linear;
      S const squared_slope = slope * slope, curved = value * (S(8) * x * x + S(4) * d);
      x = x - value * (S(2) * squared_slope - curved) /
                  (S(2) * slope * (squared_slope - curved) + S(8) * value * value * x);
    }
    S const i1 = x;
    S const i2 = S(0.5) * (i1 * i1 - squared);
    return {((sign * i1) * c + (i1 * i1 - i2) * f) - f * (transpose(f) * f), i1 * i2 - i3};
  }

  /// 2 sin(θ/2) from (scale sin θ)² and scale cos θ; beyond 120° by the cosine alone.
  template <class S>
  PLIANT_HOST_DEVICE static S chord(S squared_sine, S cosine, S scale) {
    auto const far = cosine < S(-0.5) * scale;
    return sqrt(S(2) * select(far, scale - cosine, squared_sine) /
                select(far, scale, scale * (scale + cosine)));
  }
};

}  // namespace pliant
