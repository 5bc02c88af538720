#pragma once

#include <pliant/adaptation/criterion/element_state.hpp>

// How far an element is from its rest shape.
namespace pliant {

/// R_L = max_k |l_k/L_k − 1| over the edges (Caillaud et al. 2013).
struct EdgeLengthRatio {
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    // l/L − 1 grows with s = l²/L² − 1, so the roots are taken of the extremes alone.
    S longest(0), shortest(0);
    for (int k = 0; k < State::edge_count; ++k) {
      auto const edge = e.edge(k);
      S const s = edge.squared_change / edge.squared_rest;
      longest = max(longest, s);
      shortest = min(shortest, s);
    }
    auto const ratio = [](S const& s)
                           PLIANT_INLINE { return s / (S(1) + sqrt(max(S(0), S(1) + s))); };
    return max(ratio(longest), -ratio(shortest));
  }
};

/// R_A = |A/A₀ − 1|, of the volume in 3D (Caillaud et al. 2013). Under Hooke's zero-strain motion
/// F = I + W it is tan² θ; under a true rotation it is zero.
struct AreaRatio {
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
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    auto const h = e.gradient();
    if constexpr (State::dim == 2) {
      S const sine = h(1, 0) - h(0, 1), cosine = S(2) + h(0, 0) + h(1, 1);
      return chord(sine, cosine, sqrt(sine * sine + cosine * cosine));
    } else {
      auto r = h;
      for (int i = 0; i < 3; ++i) r(i, i) = r(i, i) + S(1);
      // Higham's Newton iteration r ← (r + r⁻ᵀ)/2; from stretches in [1/2, 2] six steps give
      // rounding accuracy.
      for (int k = 0; k < 6; ++k) {
        auto const c = cofactor(r);
        S const det = r(0, 0) * c(0, 0) + r(0, 1) * c(0, 1) + r(0, 2) * c(0, 2);
        r = S(0.5) * (r + (S(1) / det) * c);
      }
      S const x = r(2, 1) - r(1, 2), y = r(0, 2) - r(2, 0), z = r(1, 0) - r(0, 1);
      return chord(sqrt(x * x + y * y + z * z), trace(r) - S(1), S(2));
    }
  }

 private:
  /// 2 sin(θ/2) from sin θ and cos θ, both times `scale`; beyond 120° by the cosine alone.
  template <class S>
  PLIANT_HOST_DEVICE static S chord(S sine, S cosine, S scale) {
    S const c = cosine / scale;
    S const half = sqrt((S(1) + max(c, S(-0.5))) / S(2));  // cos(θ/2)
    return select(c < S(-0.5), sqrt(max(S(0), S(2) - c - c)), abs(sine) / (scale * half));
  }
};

}  // namespace pliant
