#pragma once

#include <algorithm>
#include <cmath>

#include <pliant/adaptation/criterion/criterion.hpp>
#include <pliant/math/spectrum.hpp>

// How strained an element is in the middle of its cell, whatever its law; rotations do not matter.
namespace pliant {

/// |E| = √(E:E) of Green's strain E = (FᵀF − I)/2, in the plane in 2D.
struct StrainNorm {
  static constexpr Unit unit = Unit::one;

  /// |E| ≤ |H| + |H|²/2.
  static double least_gradient(double threshold, int) {
    return std::sqrt(1 + 2 * std::max(threshold, 0.0)) - 1;
  }
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    return norm(GreenInvariants<S>::strain(e.gradient()));
  }
};

/// 1 − λ with the smallest principal stretch λ: 0.2 where a line of the element is 20% shorter, negative where all are
/// longer.
struct Compression {
  static constexpr Unit unit = Unit::one;

  /// No line is shortened by more than |H| of its length.
  static double least_gradient(double threshold, int) { return threshold; }
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    auto const strains =
        Spectrum<S, State::dim>::of(GreenInvariants<S>::strain(e.gradient())).values;
    S least = strains[0];
    for (int i = 1; i < State::dim; ++i) least = min(least, strains[i]);
    S const change = S(2) * least;  // λ² − 1
    return -change / (S(1) + sqrt(max(S(0), S(1) + change)));
  }
};

}  // namespace pliant
