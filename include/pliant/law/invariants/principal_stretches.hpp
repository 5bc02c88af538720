#pragma once

#include <pliant/law/invariants/invariants.hpp>
#include <pliant/math/spectrum.hpp>

namespace pliant {

/// The singular value decomposition F = Σ λ_k n_k ⊗ N_k, λ_k in no order. Where J < 0 the smallest
/// stretch is negative, so that n and N are rotations. Not for dual numbers.
template <class S, int Dim>
struct PrincipalFrame {
  Vector<S, Dim> less_one;  // λ_k − 1
  Tensor<S, Dim> now;       // its columns are n_k
  Tensor<S, Dim> rest;      // its columns are N_k

  PLIANT_HOST_DEVICE static PrincipalFrame of(Tensor<S, Dim> const& h) {
    auto const strain = Spectrum<S, Dim>::of(GreenInvariants<S>::strain(h));
    PrincipalFrame f{{}, strain.vectors + h * strain.vectors, strain.vectors};
    constexpr auto rounding = builtin_scalar<S>(sizeof(builtin_scalar<S>) == 4 ? 1e-7 : 1e-16);
    constexpr auto half = builtin_scalar<S>(0.5);
    Vector<S, Dim> size, is_least;
    for (int k = 0; k < Dim; ++k) size[k] = sqrt(max(1 + 2 * strain.values[k], S(0)));
    S least = size[0];
    for (int k = 1; k < Dim; ++k) least = min(least, size[k]);
    S unclaimed = S(1);  // one of equal stretches is the least
    for (int k = 0; k < Dim; ++k) {
      is_least[k] = select(least < size[k], S(0), unclaimed);
      unclaimed = unclaimed - is_least[k];
    }
    for (int k = 0; k < Dim; ++k) {
      f.less_one[k] = 2 * strain.values[k] / (1 + size[k]);
      S const divisor = max(size[k], S(rounding));
      for (int i = 0; i < Dim; ++i) f.now(i, k) = f.now(i, k) / divisor;
    }
    // F N of the least stretch, which may be near zero, says little of n, but the others do; and
    // n·F N then knows the sign of the stretch, and more of its digits than its square does.
    Tensor<S, Dim> const completed = cofactor(f.now);
    for (int k = 0; k < Dim; ++k) {
      S least_stretch = completed(0, k) * f.now(0, k);
      for (int i = 1; i < Dim; ++i) least_stretch = least_stretch + completed(i, k) * f.now(i, k);
      least_stretch = least_stretch * max(size[k], S(rounding));
      S const small = is_least[k] * select(least_stretch < S(half), S(1), S(0));
      f.less_one[k] = select(S(0) < small, least_stretch - 1, f.less_one[k]);
      for (int i = 0; i < Dim; ++i)
        f.now(i, k) = select(S(0) < is_least[k], completed(i, k), f.now(i, k));
    }
    return f;
  }
  /// Σ w_kl n_k ⊗ N_l
  PLIANT_HOST_DEVICE Tensor<S, Dim> back(Tensor<S, Dim> const& w) const {
    return now * w * transpose(rest);
  }
};

/// The principal stretches λ₁, λ₂, λ₃ less one, in no order: an energy in them must not change when
/// they trade places. In 2D, plane strain: λ₃ = 1. Where J < 0 the smallest is negative.
template <class S>
struct PrincipalStretches {
  static constexpr int count = 3;
  S less_one[count];  // λ₁ − 1, λ₂ − 1, λ₃ − 1

  template <class T>
  using rebind = PrincipalStretches<T>;
  PLIANT_HOST_DEVICE S& operator[](int k) { return less_one[k]; }
  PLIANT_HOST_DEVICE S const& operator[](int k) const { return less_one[k]; }

  template <int Dim>
  PLIANT_HOST_DEVICE static PrincipalStretches of(Vector<S, Dim> const& less_one) {
    if constexpr (Dim == 2)
      return {{less_one[0], less_one[1], S(0)}};
    else
      return {{less_one[0], less_one[1], less_one[2]}};
  }
  template <int Dim>
  PLIANT_HOST_DEVICE static PrincipalStretches of(Tensor<S, Dim> const& h) {
    return of(PrincipalFrame<S, Dim>::of(h).less_one);
  }

  /// P = Σ ∂W/∂λ_k n_k ⊗ N_k
  template <class L, int Dim>
  PLIANT_HOST_DEVICE static Tensor<S, Dim> stress_of(L const& law, Tensor<S, Dim> const& h) {
    using Variable = Dual<S, count>;
    auto const frame = PrincipalFrame<S, Dim>::of(h);
    auto const stretches = of(frame.less_one);
    PrincipalStretches<Variable> variables;
    for (int k = 0; k < count; ++k) variables[k] = Variable::variable(stretches[k], k);
    Variable const w = law.energy(variables);
    auto slopes = Tensor<S, Dim>::zero();
    for (int k = 0; k < Dim; ++k) slopes(k, k) = w.derivative[k];
    return frame.back(slopes);
  }
};

/// On dual numbers: what the principal frame does as F changes is written out, as its derivative
/// has the poles 1/(λ_k − λ_l) that cancel from the change of stress.
template <class U, int N>
struct PrincipalStretches<Dual<U, N>> {
  using S = Dual<U, N>;
  static constexpr int count = 3;
  S less_one[count];  // λ₁ − 1, λ₂ − 1, λ₃ − 1

  template <class T>
  using rebind = PrincipalStretches<T>;
  PLIANT_HOST_DEVICE S& operator[](int k) { return less_one[k]; }
  PLIANT_HOST_DEVICE S const& operator[](int k) const { return less_one[k]; }

  template <int Dim>
  PLIANT_HOST_DEVICE static PrincipalStretches of(Tensor<S, Dim> const& h) {
    auto const frame = PrincipalFrame<U, Dim>::of(values(h));
    PrincipalStretches stretches{};
    for (int k = 0; k < Dim; ++k) stretches[k].value = frame.less_one[k];
    for (int n = 0; n < N; ++n) {
      auto const change = transpose(frame.now) * derivatives(h, n) * frame.rest;
      for (int k = 0; k < Dim; ++k) stretches[k].derivative[n] = change(k, k);
    }
    return stretches;
  }

  /// With dF and dP in the principal frame: dP_kk = Σ_l ∂²W/∂λ_k∂λ_l dF_ll; the symmetric part of
  /// the others is that of dF times (w_k − w_l)/(λ_k − λ_l), the skew part that times
  /// (w_k + w_l)/(λ_k + λ_l), with w_k = ∂W/∂λ_k. (Ogden, Non-Linear Elastic Deformations, 6.1.4.)
  template <class L, int Dim>
  PLIANT_HOST_DEVICE static Tensor<S, Dim> stress_of(L const& law, Tensor<S, Dim> const& h) {
    using Slope = Dual<U, count>;
    using Variable = Dual<Slope, count>;
    auto const frame = PrincipalFrame<U, Dim>::of(values(h));
    auto const l_1 = PrincipalStretches<U>::of(frame.less_one);
    PrincipalStretches<Variable> variables;
    for (int k = 0; k < count; ++k)
      variables[k] = Variable::variable(Slope::variable(l_1[k], k), k);
    Variable const w = law.energy(variables);

    auto slopes = Tensor<U, Dim>::zero();
    for (int k = 0; k < Dim; ++k) slopes(k, k) = w.value.derivative[k];
    auto const p = frame.back(slopes);
    Tensor<S, Dim> result;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) result(i, j).value = p(i, j);

    Tensor<U, Dim> stretching, turning;
    for (int k = 0; k < Dim; ++k)
      for (int l = 0; l < k; ++l) {
        U const sum = 2 + l_1[k] + l_1[l];
        turning(k, l) = (slopes(k, k) + slopes(l, l)) / sum;
        stretching(k, l) = divided_difference(w, l_1, k, l);
      }
    for (int n = 0; n < N; ++n) {
      auto const df = transpose(frame.now) * derivatives(h, n) * frame.rest;
      Tensor<U, Dim> dp;
      for (int k = 0; k < Dim; ++k) {
        dp(k, k) = w.derivative[k].derivative[0] * df(0, 0);
        for (int l = 1; l < Dim; ++l)
          dp(k, k) = dp(k, k) + w.derivative[k].derivative[l] * df(l, l);
        for (int l = 0; l < k; ++l) {
          U const even = stretching(k, l) * (df(k, l) + df(l, k)) / 2;
          U const odd = turning(k, l) * (df(k, l) - df(l, k)) / 2;
          dp(k, l) = even + odd;
          dp(l, k) = even - odd;
        }
      }
      auto const change = frame.back(dp);
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) result(i, j).derivative[n] = change(i, j);
    }
    return result;
  }

 private:
  template <int Dim>
  PLIANT_HOST_DEVICE static Tensor<U, Dim> values(Tensor<S, Dim> const& h) {
    Tensor<U, Dim> v;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) v(i, j) = h(i, j).value;
    return v;
  }
  template <int Dim>
  PLIANT_HOST_DEVICE static Tensor<U, Dim> derivatives(Tensor<S, Dim> const& h, int n) {
    Tensor<U, Dim> v;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) v(i, j) = h(i, j).derivative[n];
    return v;
  }
  /// (w_k − w_l)/(λ_k − λ_l); between stretches closer than the cube root of the rounding, its
  /// limit ∂²W/∂λ_k² − ∂²W/∂λ_k∂λ_l in the middle, which is off by the square of their difference.
  PLIANT_HOST_DEVICE static U divided_difference(Dual<Dual<U, 3>, 3> const& w,
                                                 PrincipalStretches<U> const& l_1, int k, int l) {
    constexpr double close = sizeof(builtin_scalar<U>) == 4 ? 5e-3 : 6e-6;
    U const gap = l_1[k] - l_1[l];
    auto const is_close = abs(gap) < U(close);
    U const limit = (w.derivative[k].derivative[k] + w.derivative[l].derivative[l]) / 2 -
                    w.derivative[k].derivative[l];
    U const rise = w.value.derivative[k] - w.value.derivative[l];
    return select(is_close, limit, rise / select(is_close, U(1), gap));
  }
};

}  // namespace pliant
