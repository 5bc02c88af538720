#pragma once

#include <pliant/law/law.hpp>

namespace pliant {

/// Corotated linear: W = μ |F − R|² + λ/2 (tr(RᵀF − I))² with the rotation R of the polar
/// decomposition F = R U. Hooke's law without its error under rotation, and no more than that: a
/// finite energy resists inversion. Defined for every F. Where J < 0, R stays a rotation, and U has one negative
/// eigenvalue; R jumps where two eigenvalues add up to 0, the mirrored states, about which the
/// energy is good to 1%. (Chao, Pinkall, Sanan and Schröder, A simple geometric model for elastic
/// deformations, ACM Trans. Graph. 29, 2010.)
template <class T>
struct Corotated {
  T lambda, mu;  // Lamé's parameters, Pa: μ > 0, 3λ + 2μ > 0

  static constexpr bool takes_inversion = true;

  /// In tr U: |F − R|² = I₁ + 3 − 2 tr U and tr(RᵀF − I) = tr U − 3.
  template <class S>
  PLIANT_HOST_DEVICE S energy(PrincipalInvariants<S> const& i) const {
    S const s = trace_beyond_volume(i);  // tr U − 3 − (J − 1)
    return mu * (i.D1 - 2 * s) + lambda / 2 * square(i.J_minus_1 + s);
  }
  void check() const { detail::demand_lame("the corotated law", lambda, mu); }
  static Corotated from(Elastic const& m) { return {T(m.lame_lambda()), T(m.lame_mu())}; }

 private:
  /// tr U is the largest root f of f⁴ − 2 I₁ f² − 8 J f + I₁² − 4 I₂ (Lin, Floyd, Chitalu and
  /// Komura, Isotropic ARAP energy using Cauchy-Green invariants, ACM Trans. Graph. 41, 2022),
  /// written here in s = f − 3 − (J − 1), which is of second order, so that nothing of first order
  /// cancels.
  template <class S>
  struct Quartic {
    S J_minus_1, x, constant;  // J − 1, I₁ − 3

    PLIANT_HOST_DEVICE explicit Quartic(PrincipalInvariants<S> const& i)
        : J_minus_1(i.J_minus_1), x(i.I1_minus_3()), constant(x * x - 12 * i.D1 - 4 * i.D2) {}
    PLIANT_HOST_DEVICE S value(S const& s) const {
      S const a = J_minus_1 + s;
      return 64 * s + constant +
             a * (48 * a - 12 * x - 8 * J_minus_1 + a * (12 * a - 2 * x + square(a)));
    }
    PLIANT_HOST_DEVICE S slope(S const& s) const {
      S const a = J_minus_1 + s;
      return 64 - 12 * x - 8 * J_minus_1 + a * (96 - 4 * x + a * (36 + 4 * a));
    }
    PLIANT_HOST_DEVICE S curvature(S const& s) const {
      S const a = J_minus_1 + s;
      return 96 - 4 * x + a * (72 + 12 * a);
    }
  };
  /// By Laguerre's method from √(3 I₁), which lies above all roots: 3 steps are exact to 12 digits
  /// at stretches of 0.3 to 3. A step of Newton's method brings the last digits.
  template <class S>
  PLIANT_HOST_DEVICE static S trace_beyond_volume(PrincipalInvariants<S> const& i) {
    Quartic<S> const q(i);
    S root = 3 * q.x / (sqrt(9 + 3 * q.x) + 3) - q.J_minus_1;
    for (int step = 0; step < 5; ++step) {
      S const p = q.value(root), slope = q.slope(root);
      S const reach = sqrt(max(9 * square(slope) - 12 * p * q.curvature(root), S(0)));
      root = root - 4 * p / max(slope + reach, flattest<S>());
    }
    return root - q.value(root) / max(q.slope(root), flattest<S>());
  }
  /// On dual numbers, the derivative of the root: that of the quartic over its slope.
  template <class S, int N>
  PLIANT_HOST_DEVICE static Dual<S, N> trace_beyond_volume(
      PrincipalInvariants<Dual<S, N>> const& i) {
    PrincipalInvariants<S> const values{i.D1.value, i.D2.value, i.J_minus_1.value};
    S const root = trace_beyond_volume(values);
    S const slope = max(Quartic<S>(values).slope(root), flattest<S>());
    return root - Quartic<Dual<S, N>>(i).value(Dual<S, N>(root)) * (1 / slope);
  }
  /// The slope is 0 where two stretches add up to 0.
  template <class S>
  PLIANT_HOST_DEVICE static S flattest() {
    return S(builtin_scalar<S>(1e-3));
  }
};

}  // namespace pliant
