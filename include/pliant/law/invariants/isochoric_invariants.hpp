#pragma once

#include <pliant/law/invariants/invariants.hpp>

// Invariants with I₂, and those of the isochoric part F̄ = J^(−1/3) F of a deformation.
namespace pliant {

/// Of the right Cauchy-Green tensor: the distortions D1 = I₁ − 3 − 2(J − 1) and
/// D2 = I₂ − 3 − 4(J − 1), which are of second order in the strain, and J − 1.
template <class S>
struct PrincipalInvariants {
  static constexpr int count = 3;
  S D1;         // I₁ − 3 − 2(J − 1)
  S D2;         // I₂ − 3 − 4(J − 1)
  S J_minus_1;  // J − 1

  PLIANT_HOST_DEVICE S I1_minus_3() const { return D1 + (J_minus_1 + J_minus_1); }  // I₁ − 3
  PLIANT_HOST_DEVICE S I2_minus_3() const { return D2 + 4 * J_minus_1; }            // I₂ − 3

  template <class T>
  using rebind = PrincipalInvariants<T>;

  template <int Dim>
  PLIANT_HOST_DEVICE static PrincipalInvariants of(Tensor<S, Dim> const& h) {
    auto const first = CauchyGreenInvariants<S>::of(h);
    if constexpr (Dim == 2) {
      return {first.D, first.D + square(first.J_minus_1), first.J_minus_1};
    } else {
      // I₂ − 3 = 4 tr E + 2 ((tr E)² − E:E), and 2 tr E = I₁ − 3.
      Tensor<S, 3> const e = GreenInvariants<S>::strain(h);
      S const beyond = square(pliant::trace(e)) - dot(e, e);
      return {first.D, 2 * (first.D + beyond), first.J_minus_1};
    }
  }
  /// With ∂I₂/∂F = 2 (I₁ F − F C) = 4 F (I + tr E I − E).
  template <int Dim>
  PLIANT_HOST_DEVICE static Tensor<S, Dim> stress(PrincipalInvariants const& w,
                                                  Tensor<S, Dim> const& h) {
    if constexpr (Dim == 2) {
      S const J_minus_1 = determinant_less_one(h);
      return CauchyGreenInvariants<S>::stress(
          CauchyGreenInvariants<S>{w.D1 + w.D2, w.J_minus_1 + (w.D2 + w.D2) * J_minus_1}, h);
    } else {
      Tensor<S, 3> m = builtin_scalar<S>(-1) * GreenInvariants<S>::strain(h);
      S const t = -pliant::trace(m);
      for (int i = 0; i < 3; ++i) m(i, i) = m(i, i) + t;
      auto const distortions = CauchyGreenInvariants<S>::stress(
          CauchyGreenInvariants<S>{w.D1 + (w.D2 + w.D2), w.J_minus_1}, h);
      return distortions + (4 * w.D2) * (m + h * m);
    }
  }
};

namespace detail {

/// Powers of J, NaN where J ≤ 0; neither the root nor the division waits for the other.
template <class S>
struct PowersOfJ {
  S x, inverse, inverse_square;  // J^(1/3), 1/J, J^(−2/3)

  PLIANT_HOST_DEVICE explicit PowersOfJ(S const& J_minus_1)
      : x(cbrt(1 + J_minus_1)),
        inverse(1 / positive_or_nan(1 + J_minus_1)),
        inverse_square(x * inverse) {}
  /// J^(1/3) − 1
  PLIANT_HOST_DEVICE S less_one(S const& J_minus_1) const {
    return J_minus_1 / (square(x) + x + 1);
  }
};

}  // namespace detail

/// Of the isochoric part of a deformation, Ī₁ − 3 with Ī₁ = J^(−2/3) I₁, and J − 1. NaN for J ≤ 0.
template <class S>
struct IsochoricInvariants {
  static constexpr int count = 2;
  S I1_minus_3;  // Ī₁ − 3
  S J_minus_1;   // J − 1

  template <class T>
  using rebind = IsochoricInvariants<T>;

  /// Ī₁ − 3 = (D + 3 + 2(J − 1) − 3 x²)/x² with x = J^(1/3), whose terms but D make (x − 1)² (2x +
  /// 1).
  PLIANT_HOST_DEVICE static S first(S const& D, S const& x, S const& x_1, S const& inverse_square) {
    return (D + square(x_1) * (2 * x + 1)) * inverse_square;
  }

  template <int Dim>
  PLIANT_HOST_DEVICE static IsochoricInvariants of(Tensor<S, Dim> const& h) {
    auto const i = CauchyGreenInvariants<S>::of(h);
    detail::PowersOfJ<S> const J(i.J_minus_1);
    return {first(i.D, J.x, J.less_one(i.J_minus_1), J.inverse_square), i.J_minus_1};
  }
  template <int Dim>
  PLIANT_HOST_DEVICE static Tensor<S, Dim> stress(IsochoricInvariants const& w,
                                                  Tensor<S, Dim> const& h) {
    auto const i = CauchyGreenInvariants<S>::of(h);
    detail::PowersOfJ<S> const J(i.J_minus_1);
    S const by_D = w.I1_minus_3 * J.inverse_square;
    S const by_J = builtin_scalar<S>(2.0 / 3) * by_D * (i.J_minus_1 - i.D) * J.inverse;
    return CauchyGreenInvariants<S>::stress(CauchyGreenInvariants<S>{by_D, w.J_minus_1 + by_J}, h);
  }
};

/// Of the isochoric part of a deformation, Ī₁ − 3 and Ī₂ − 3 with Ī₂ = J^(−4/3) I₂, and J − 1. NaN
/// for J ≤ 0.
template <class S>
struct MooneyInvariants {
  static constexpr int count = 3;
  S I1_minus_3;  // Ī₁ − 3
  S I2_minus_3;  // Ī₂ − 3
  S J_minus_1;   // J − 1

  template <class T>
  using rebind = MooneyInvariants<T>;

  /// Ī₂ is the Ī₁ of cof F, whose determinant is J².
  template <int Dim>
  PLIANT_HOST_DEVICE static MooneyInvariants of(Tensor<S, Dim> const& h) {
    auto const i = PrincipalInvariants<S>::of(h);
    detail::PowersOfJ<S> const J(i.J_minus_1);
    S const x_1 = J.less_one(i.J_minus_1);
    S const cofactors_D = i.D2 - 2 * square(i.J_minus_1);  // I₂ − 3 − 2(J² − 1)
    return {IsochoricInvariants<S>::first(i.D1, J.x, x_1, J.inverse_square),
            IsochoricInvariants<S>::first(cofactors_D, square(J.x), x_1 * (J.x + 1),
                                          square(J.inverse_square)),
            i.J_minus_1};
  }
  template <int Dim>
  PLIANT_HOST_DEVICE static Tensor<S, Dim> stress(MooneyInvariants const& w,
                                                  Tensor<S, Dim> const& h) {
    auto const i = PrincipalInvariants<S>::of(h);
    detail::PowersOfJ<S> const J(i.J_minus_1);
    S const by_D1 = w.I1_minus_3 * J.inverse_square,
            by_D2 = w.I2_minus_3 * square(J.inverse_square);
    S const by_J = builtin_scalar<S>(2.0 / 3) * J.inverse *
                   (by_D1 * (i.J_minus_1 - i.D1) - 2 * by_D2 * (i.J_minus_1 + i.D2));
    return PrincipalInvariants<S>::stress({by_D1, by_D2, w.J_minus_1 + by_J}, h);
  }
};

}  // namespace pliant
