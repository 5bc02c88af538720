#pragma once

#include <cmath>
#include <limits>

#include <pliant/config.hpp>

namespace pliant::detail {

/// The numbers of MINRES (Paige and Saunders, SIAM Journal on Numerical Analysis 12 (1975) 617), preconditioned and named as in
/// Elman, Silvester and Wathen, Finite Elements and Fast Iterative Solvers, 2014, algorithm 4.1: the tridiagonal matrix that
/// Lanczos' method makes of A, of δ and γ, is turned into a triangular one by plane rotations.
struct MinresNumbers {
  double gamma;         // √vᵀMv of the present Lanczos vector
  double gamma_before;  // and of the one before; of no account in the first iteration
  double rounding;      // unit roundoff of the vectors
  double c = 1, s = 0, c_before = 1, s_before = 0;  // rotations
  double eta = gamma;                               // ±|r| in the norm of M
  double largest = 0;                               // of α₁: about |A|
  double alpha_1 = 1, alpha_2 = 0, alpha_3 = 0;  // of the present column of the triangular matrix
  double ahead = 0;                              // x += ahead · w
  double kept = 1, taken = 0;                    // r = kept · r − taken · v'
  enum class State { goes_on, unfit, singular } state = State::goes_on;
  bool indefinite = false;  // whether a residual r with (Mr)ᵀ A Mr ≤ 0 was met

  PLIANT_HOST_DEVICE static MinresNumbers first(double vz, double rounding) {
    return {.gamma = std::sqrt(vz > 0 ? vz : 0), .gamma_before = 1, .rounding = rounding};
  }
  /// From δ = pᵀAp along p = Mv/γ, and v'ᵀMv' of the next Lanczos vector v' = A p − δ/γ v − γ/γ₋₁ v₋₁.
  PLIANT_HOST_DEVICE void rotate(double delta, double next_vz) {
    double const scale = 8 * rounding * (std::abs(delta) + gamma + largest);
    if (!(gamma > 0) || !(next_vz >= -scale * scale)) {
      state = State::unfit;
      return;
    }
    double const next = std::sqrt(next_vz > 0 ? next_vz : 0);
    double const alpha_0 = c * delta - c_before * s * gamma;
    alpha_1 = std::hypot(alpha_0, next);
    alpha_2 = s * delta + c_before * c * gamma;
    alpha_3 = s_before * gamma;
    largest = alpha_1 > largest ? alpha_1 : largest;
    // The Krylov space ends, and A is singular there.
    if (alpha_1 <= 8 * rounding * largest) {
      state = State::singular;
      return;
    }
    // The sign of the curvature along the residual (Liu and Roosta, SIAM Journal on Optimization 32 (2022) 1100).
    indefinite = indefinite || !(c * alpha_0 > 0);
    c_before = c;
    s_before = s;
    c = alpha_0 / alpha_1;
    s = next / alpha_1;
    ahead = c * eta;
    kept = s * s;
    taken = ahead / alpha_1;
    eta = -s * eta;
    gamma_before = gamma;
    gamma = next;
  }
};

}  // namespace pliant::detail
