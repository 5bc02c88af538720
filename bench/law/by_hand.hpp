#pragma once

#include <pliant/pliant.hpp>

// Twins of the library's laws whose stress is written by hand, as one would who had no automatic
// differentiation: what every law costs at least. In 3D. With C = cof F − I, all in shifted form, so
// that twins keep as many digits.
namespace pliant::bench::by_hand {

/// P = λ tr e I + 2μ e
template <class T>
struct Hooke : pliant::Hooke<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    S const first = this->lambda * trace(h);
    Tensor<S, 3> p;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) p(i, j) = p(j, i) = this->mu * (h(i, j) + h(j, i));
    for (int i = 0; i < 3; ++i) p(i, i) = p(i, i) + first;
    return p;
  }
};

/// P = F S, S = λ tr E I + 2μ E
template <class T>
struct SaintVenantKirchhoff : pliant::SaintVenantKirchhoff<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    auto const second = second_of(GreenInvariants<S>::strain(h));
    return second + h * second;
  }
  /// dP = dF S + F dS, dE = sym(Fᵀ dF)
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> change(Tensor<S, 3> const& h, Tensor<S, 3> const& dh) const {
    auto const second = second_of(GreenInvariants<S>::strain(h));
    auto const d_second = second_of(symmetric_part(dh + transpose(h) * dh));
    return dh * second + d_second + h * d_second;
  }

 private:
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> second_of(Tensor<S, 3> const& e) const {
    Tensor<S, 3> second = 2 * this->mu * e;
    S const first = this->lambda * trace(e);
    for (int i = 0; i < 3; ++i) second(i, i) = second(i, i) + first;
    return second;
  }
};

/// a (H − C) + b cof F
template <class S>
PLIANT_HOST_DEVICE Tensor<S, 3> combined(S const& a, S const& b, Tensor<S, 3> const& h,
                                         Tensor<S, 3> const& c) {
  Tensor<S, 3> p = a * (h - c) + b * c;
  for (int i = 0; i < 3; ++i) p(i, i) = p(i, i) + b;
  return p;
}
/// dC
template <class S>
PLIANT_HOST_DEVICE Tensor<S, 3> cofactor_change(Tensor<S, 3> const& h, Tensor<S, 3> const& dh) {
  Tensor<S, 3> c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      int const i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c(i, j) = dh(i1, j1) * h(i2, j2) + h(i1, j1) * dh(i2, j2) - dh(i1, j2) * h(i2, j1) -
                h(i1, j2) * dh(i2, j1) - dh(j, i);
    }
  S const first = trace(dh);
  for (int i = 0; i < 3; ++i) c(i, i) = c(i, i) + first;
  return c;
}

/// P = μ (H − C) + (λ + μ)(J − 1) cof F
template <class T>
struct StableNeoHookean : pliant::StableNeoHookean<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    S const pressure = (this->lambda + this->mu) * determinant_less_one(h);
    return combined(S(this->mu), pressure, h, cofactor_less_identity(h));
  }
  /// dJ = cof F : dF
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> change(Tensor<S, 3> const& h, Tensor<S, 3> const& dh) const {
    auto const c = cofactor_less_identity(h), dc = cofactor_change(h, dh);
    S const both = S(this->lambda + this->mu), dJ = trace(dh) + dot(c, dh);
    Tensor<S, 3> dp = this->mu * (dh - dc) + both * determinant_less_one(h) * dc + both * dJ * c;
    for (int i = 0; i < 3; ++i) dp(i, i) = dp(i, i) + both * dJ;
    return dp;
  }
};

/// P = μ (H − C) + (μ (J − 1) + λ ln J)/J cof F
template <class T>
struct NeoHookean : pliant::NeoHookean<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    S const J_minus_1 = determinant_less_one(h);
    S const pressure = (this->mu * J_minus_1 + this->lambda * log1p(J_minus_1)) / (1 + J_minus_1);
    return combined(S(this->mu), pressure, h, cofactor_less_identity(h));
  }
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> change(Tensor<S, 3> const& h, Tensor<S, 3> const& dh) const {
    auto const c = cofactor_less_identity(h), dc = cofactor_change(h, dh);
    S const J_minus_1 = determinant_less_one(h), inverse = 1 / (1 + J_minus_1);
    S const pressure = (this->mu * J_minus_1 + this->lambda * log1p(J_minus_1)) * inverse;
    S const dJ = trace(dh) + dot(c, dh);
    S const d_pressure = (this->mu + this->lambda * inverse - pressure) * inverse * dJ;
    Tensor<S, 3> dp = this->mu * (dh - dc) + pressure * dc + d_pressure * c;
    for (int i = 0; i < 3; ++i) dp(i, i) = dp(i, i) + d_pressure;
    return dp;
  }
};

/// A part in Ī₁ with the slope W₁ = ∂W/∂Ī₁ and a part in J with the slope p:
/// P = 2 W₁ J^(−2/3) (F − I₁/3 F⁻ᵀ) + p cof F.
template <class S>
struct Isochoric {
  Tensor<S, 3> c;
  S D, J_minus_1, inverse_J, x, inverse_square;  // x = J^(1/3)

  PLIANT_HOST_DEVICE explicit Isochoric(Tensor<S, 3> const& h) : c(cofactor_less_identity(h)) {
    S const beyond = determinant_beyond_trace(h);
    D = dot(h, h) - (beyond + beyond);
    J_minus_1 = trace(h) + beyond;
    x = cbrt(1 + J_minus_1);
    inverse_J = 1 / (1 + J_minus_1);
    inverse_square = x * inverse_J;
  }
  /// Ī₁ − 3
  PLIANT_HOST_DEVICE S I1_minus_3() const {
    S const x_1 = J_minus_1 / (square(x) + x + 1);
    return (D + square(x_1) * (2 * x + 1)) * inverse_square;
  }
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(S const& W1, S const& p, Tensor<S, 3> const& h) const {
    using T = builtin_scalar<S>;
    S const shape = 2 * W1 * inverse_square;
    return combined(shape, p + T(1.0 / 3) * shape * (J_minus_1 - D) * inverse_J, h, c);
  }
};

/// W₁ = μ/2
template <class T>
struct IsochoricNeoHookean : pliant::IsochoricNeoHookean<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    Isochoric<S> const i(h);
    return i.stress(S(this->mu / 2), this->bulk * i.J_minus_1, h);
  }
};
/// W₁ = μ/2, p = κ/2 (J − 1/J)
template <class T>
struct SimoNeoHookean : pliant::SimoNeoHookean<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    Isochoric<S> const i(h);
    return i.stress(S(this->mu / 2), this->bulk / 2 * i.J_minus_1 * (2 + i.J_minus_1) * i.inverse_J,
                    h);
  }
};
/// W₁ = c₁ + 2 c₂ (Ī₁ − 3) + 3 c₃ (Ī₁ − 3)²
template <class T>
struct Yeoh : pliant::Yeoh<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    Isochoric<S> const i(h);
    S const y = i.I1_minus_3();
    return i.stress(this->c1 + y * (2 * this->c2 + 3 * this->c3 * y), this->bulk * i.J_minus_1, h);
  }
};
/// W₁ = μ/2 / (1 − (Ī₁ − 3)/Jₘ)
template <class T>
struct Gent : pliant::Gent<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    Isochoric<S> const i(h);
    S const W1 = this->mu * this->limit / 2 / (this->limit - i.I1_minus_3());
    return i.stress(W1, this->bulk * i.J_minus_1, h);
  }
};
/// W₁ = μ₀ Σ k aₖ (Ī₁/λₘ²)^(k−1)
template <class T>
struct ArrudaBoyce : pliant::ArrudaBoyce<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    Isochoric<S> const i(h);
    S const y = (3 + i.I1_minus_3()) * (1 / square(this->locking));
    S const sum =
        T(0.5) + y * (T(0.1) + y * (T(11.0 / 350) + y * (T(19.0 / 1750) + y * T(519.0 / 134750))));
    return i.stress(this->mu * sum, this->bulk * i.J_minus_1, h);
  }
};
/// P = 2 c₁ J^(−2/3) (F − I₁/3 F⁻ᵀ) + 2 c₂ J^(−4/3) (I₁ F − F C − 2/3 I₂ F⁻ᵀ) + κ (J − 1) cof F
template <class T>
struct MooneyRivlin : pliant::MooneyRivlin<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    Isochoric<S> const i(h);
    Tensor<S, 3> m = GreenInvariants<S>::strain(h);
    S const t = trace(m), D2 = 2 * (i.D + square(t) - dot(m, m));  // I₂ − 3 − 4(J − 1)
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l) m(k, l) = k == l ? t - m(k, k) : -m(k, l);
    S const first = 2 * this->c1 * i.inverse_square;
    S const second = 4 * this->c2 * square(i.inverse_square);
    S const pressure =
        this->bulk * i.J_minus_1 +
        T(1.0 / 3) * i.inverse_J * (first * (i.J_minus_1 - i.D) - second * (i.J_minus_1 + D2));
    return combined(first + second, pressure, h, i.c) + second * (m + h * m);
  }
};

/// P = F S, S = e^Q (λ tr E I + 2μ E)
template <class T>
struct Fung : pliant::Fung<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    Tensor<S, 3> second = GreenInvariants<S>::strain(h);
    S const t = trace(second);
    S const growth =
        exp(this->exponent * (2 * dot(second, second) + this->lambda / this->mu * square(t)));
    second = (2 * this->mu * growth) * second;
    for (int i = 0; i < 3; ++i) second(i, i) = second(i, i) + this->lambda * t * growth;
    return second + h * second;
  }
};

/// P = F S + κ (J − 1) cof F, S = c e^Q (b_t E + (b_f + b_t − 2 b_fs) E_ff f⊗f
///     + (b_fs − b_t)(E f⊗f + f⊗E f))
template <class T>
struct Guccione : pliant::Guccione<T> {
  template <class S>
  struct Along : pliant::Guccione<T>::template Along<S> {
    template <class V>
    PLIANT_HOST_DEVICE Tensor<V, 3> stress(Tensor<V, 3> const& h) const {
      auto const& [c, fibre, transverse, shearing, bulk] = this->law;
      auto const& a = this->fibres[0];
      auto const e = GreenInvariants<V>::strain(h);
      Vector<V, 3> ef;
      for (int i = 0; i < 3; ++i) ef[i] = e(i, 0) * a[0] + e(i, 1) * a[1] + e(i, 2) * a[2];
      V const ff = ef[0] * a[0] + ef[1] * a[1] + ef[2] * a[2];
      T const axial = fibre + transverse - 2 * shearing, mixed = shearing - transverse;
      V const growth =
          c * exp(transverse * dot(e, e) + axial * square(ff) + 2 * mixed * dot(ef, ef));
      V const round = transverse * growth, along = mixed * growth, half = axial * growth * ff / 2;
      Vector<V, 3> g;  // mixed E f + axial E_ff f / 2
      for (int i = 0; i < 3; ++i) g[i] = along * ef[i] + half * a[i];
      Tensor<V, 3> second;
      for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
          second(i, j) = second(j, i) = round * e(i, j) + g[i] * a[j] + g[j] * a[i];
      V const pressure = bulk * determinant_less_one(h);
      Tensor<V, 3> p = second + h * second + pressure * cofactor_less_identity(h);
      for (int i = 0; i < 3; ++i) p(i, i) = p(i, i) + pressure;
      return p;
    }
  };
  template <class S>
  PLIANT_HOST_DEVICE Along<S> at(Vector<S, 3> const& f) const {
    return {pliant::Guccione<T>::at(f)};
  }
};

/// P = F S beside that of the matrix, S = Σ k₁ ⟨ε⟩ exp(k₂ ⟨ε⟩²) (2d I + 2 (1 − 3d) a⊗a)
template <class T>
struct HolzapfelGasserOgden : pliant::HolzapfelGasserOgden<T> {
  template <class S>
  struct Along : pliant::HolzapfelGasserOgden<T>::template Along<S> {
    Vector<S, 3> directions[2];
    template <class V>
    PLIANT_HOST_DEVICE Tensor<V, 3> stress(Tensor<V, 3> const& h) const {
      auto const e = GreenInvariants<V>::strain(h);
      auto second = Tensor<V, 3>::zero();
      add(second, directions[0], e);
      add(second, directions[1], e);
      Isochoric<V> const i(h);
      return i.stress(V(this->law.mu / 2), this->law.bulk * i.J_minus_1, h) + second + h * second;
    }

   private:
    template <class V>
    PLIANT_HOST_DEVICE void add(Tensor<V, 3>& second, Vector<S, 3> const& a,
                                Tensor<V, 3> const& e) const {
      T const d = this->law.dispersion;
      S const spread = 2 * d * dot(a, a);
      Vector<V, 3> ea;
      for (int i = 0; i < 3; ++i) ea[i] = e(i, 0) * a[0] + e(i, 1) * a[1] + e(i, 2) * a[2];
      V const strain =
          spread * trace(e) + 2 * (1 - 3 * d) * (ea[0] * a[0] + ea[1] * a[1] + ea[2] * a[2]);
      V const stretched = max(strain, V(0));
      V const size = this->law.k1 * stretched * exp(this->law.k2 * square(stretched));
      V const along = 2 * (1 - 3 * d) * size;
      for (int i = 0; i < 3; ++i) {
        second(i, i) = second(i, i) + spread * size;
        for (int j = 0; j < 3; ++j) second(i, j) = second(i, j) + along * (a[i] * a[j]);
      }
    }
  };
  template <class S>
  PLIANT_HOST_DEVICE Along<S> at(Vector<S, 6> const& a) const {
    return {pliant::HolzapfelGasserOgden<T>::at(a),
            {pliant::detail::normalised(Vector<S, 3>{{{a[0]}, {a[1]}, {a[2]}}}),
             pliant::detail::normalised(Vector<S, 3>{{{a[3]}, {a[4]}, {a[5]}}})}};
  }
};

/// P = Σ w_k n_k⊗N_k, λ_k w_k = Σₚ μₚ (λ̄_k^αₚ − Σ_l λ̄_l^αₚ/3) + κ (J − 1) J. Not for tangents.
template <class T>
struct Ogden : pliant::Ogden<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    auto const frame = PrincipalFrame<S, 3>::of(h);
    S const J_minus_1 = determinant_less_one(h);
    S log_bar[3], slopes[3];
    for (int k = 0; k < 3; ++k) log_bar[k] = log1p(frame.less_one[k]);
    S const mean = (log_bar[0] + log_bar[1] + log_bar[2]) / 3;
    for (S& slope : slopes) slope = this->bulk * J_minus_1 * (1 + J_minus_1);
    for (int p = 0; p < 3; ++p) {
      S power[3];
      for (int k = 0; k < 3; ++k) power[k] = expm1(this->alpha[p] * (log_bar[k] - mean));
      S const third = (power[0] + power[1] + power[2]) / 3;
      for (int k = 0; k < 3; ++k) slopes[k] = slopes[k] + this->mu[p] * (power[k] - third);
    }
    auto w = Tensor<S, 3>::zero();
    for (int k = 0; k < 3; ++k) w(k, k) = slopes[k] / (1 + frame.less_one[k]);
    return frame.back(w);
  }
};

/// P = 2μ (F − R) + λ tr(RᵀF − I) R with R = ∂(tr U)/∂F, the derivative of the root of a quartic:
/// see pliant::Corotated.
template <class T>
struct Corotated : pliant::Corotated<T> {
  template <class S>
  PLIANT_HOST_DEVICE Tensor<S, 3> stress(Tensor<S, 3> const& h) const {
    auto const i = PrincipalInvariants<S>::of(h);
    S const J_minus_1 = i.J_minus_1, x = i.I1_minus_3();
    S const s = pliant::Corotated<T>{T(0), T(-0.5)}.energy(i) + i.D1 / 2;  // tr U − 3 − (J − 1)
    S const a = J_minus_1 + s, square_a = square(a);
    S const by_x = 2 * (x - 6 * a - square_a);
    S const by_a = 96 * a - 12 * x - 8 * J_minus_1 + a * (36 * a - 4 * x + 4 * square_a);
    S const inverse = 1 / (64 + by_a);
    S const s_D1 = (12 - by_x) * inverse, s_D2 = 4 * inverse;
    S const s_J = (8 * a - 2 * by_x - by_a) * inverse;
    S const first = this->lambda * a, by_s = first - 2 * this->mu;
    return PrincipalInvariants<S>::stress({this->mu + by_s * s_D1, by_s * s_D2, first + by_s * s_J},
                                          h);
  }
};

/// A twin whose tangent is written by hand too.
template <template <class> class L>
struct WithTangent {
  template <class T>
  struct law : L<T> {
    using L<T>::stress;
    template <class S>
    PLIANT_HOST_DEVICE Tensor<Dual<S, 1>, 3> stress(Tensor<Dual<S, 1>, 3> const& h) const {
      Tensor<S, 3> value, change;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          value(i, j) = h(i, j).value;
          change(i, j) = h(i, j).derivative[0];
        }
      auto const p = L<T>::stress(value), dp = L<T>::change(value, change);
      Tensor<Dual<S, 1>, 3> both;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          both(i, j).value = p(i, j);
          both(i, j).derivative[0] = dp(i, j);
        }
      return both;
    }
  };
};

}  // namespace pliant::bench::by_hand
