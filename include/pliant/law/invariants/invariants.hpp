#pragma once

#include <utility>

#include <pliant/math/dual.hpp>
#include <pliant/math/matrix.hpp>

// Sets of invariants in which an isotropic energy may be written. Each is computed from the
// displacement gradient H = F − I, shifted so that it vanishes at rest (nothing is rounded away at
// small strain), and knows how its derivatives make up the first Piola-Kirchhoff stress
// P = Σ ∂W/∂i · ∂i/∂F. In 2D, plane strain: F₃₃ = 1.
namespace pliant {

namespace detail {

/// Invariant K of a set as a variable to differentiate by: member K, or entry K of a set that is an array.
template <class Variable, int K, class Family>
PLIANT_HOST_DEVICE Variable variable_of(Family const& i) {
  using Value = decltype(Variable::value);
  if constexpr (requires { i[K]; }) {
    return Variable::variable(Value(i[K]), K);
  } else if constexpr (Family::count == 1) {
    auto const& [a] = i;
    return Variable::variable(Value(a), K);
  } else if constexpr (Family::count == 2) {
    auto const& [a, b] = i;
    return Variable::variable(Value(K == 0 ? a : b), K);
  } else {
    auto const& [a, b, c] = i;
    return Variable::variable(Value(K == 0 ? a : K == 1 ? b : c), K);
  }
}

/// A number that knows its zeros, where it is a dual one.
template <class S>
PLIANT_HOST_DEVICE S const& knowing_zeros(S const& x) {
  return x;
}
template <class T, int N>
PLIANT_HOST_DEVICE Dual<T, N, Zeros::known> knowing_zeros(Dual<T, N> const& x) {
  return Dual<T, N, Zeros::known>(x);
}

// Made at once: to assign entry by entry would be copies, which compilers do not see through.
template <class Slope, Zeros Z, class L, class Family, int... K>
PLIANT_HOST_DEVICE auto slopes_of(L const& law, Family const& i, std::integer_sequence<int, K...>) {
  using Variable = Dual<Slope, Family::count, Z>;
  using Variables = typename Family::template rebind<Variable>;
  Variable const w = law.energy(Variables{variable_of<Variable, K>(i)...});
  return typename Family::template rebind<Slope>{w.derivative[K]...};
}
/// The derivatives of an energy by each of its invariants of type S.
template <class S, class L, class Family>
PLIANT_HOST_DEVICE Family slopes_of(L const& law, Family const& i) {
  return slopes_of<S, Zeros::unknown>(law, i, std::make_integer_sequence<int, Family::count>());
}

template <class S>
struct KnowingZeros {
  using type = S;
};
template <class T, int N>
struct KnowingZeros<Dual<T, N>> {
  using type = Dual<T, N, Zeros::known>;
};
/// The same, as numbers that know their zeros where S is a dual one.
template <class S, class L, class Family>
PLIANT_HOST_DEVICE auto slopes_knowing_zeros(L const& law, Family const& i) {
  return slopes_of<typename KnowingZeros<S>::type, Zeros::known>(
      law, i, std::make_integer_sequence<int, Family::count>());
}
/// A set of invariants whose `stress` takes such derivatives.
template <class Family, int Dim>
concept MakesStressOfKnownZeros =
    requires(typename Family::template rebind<Dual<double, 1, Zeros::known>> const& w,
             Tensor<Dual<double, 1>, Dim> const& h) {
      Family::template rebind<Dual<double, 1>>::stress(w, h);
    };

}  // namespace detail

/// Of the small strain e = sym H: tr e and e:e.
template <class S>
struct StrainInvariants {
  static constexpr int count = 2;
  S trace;    // tr e
  S squares;  // e:e

  template <class T>
  using rebind = StrainInvariants<T>;

  template <int Dim>
  PLIANT_HOST_DEVICE static StrainInvariants of(Tensor<S, Dim> const& h) {
    Tensor<S, Dim> const e = symmetric_part(h);
    return {pliant::trace(e), dot(e, e)};
  }
  /// P from the derivatives `w` of the energy by each invariant.
  template <class W, int Dim>
  PLIANT_HOST_DEVICE static Tensor<S, Dim> stress(StrainInvariants<W> const& w,
                                                  Tensor<S, Dim> const& h) {
    Tensor<S, Dim> p = w.squares * (h + transpose(h));
    for (int i = 0; i < Dim; ++i) p(i, i) = p(i, i) + S(w.trace);
    return p;
  }
};

/// Of the right Cauchy-Green tensor C = FᵀF: the distortion D = I₁ − 3 − 2(J − 1), which is of
/// second order in the strain, and J − 1 with J = det F. I₁ − 3 follows from both.
template <class S>
struct CauchyGreenInvariants {
  static constexpr int count = 2;
  S D;          // I₁ − 3 − 2(J − 1)
  S J_minus_1;  // J − 1

  PLIANT_HOST_DEVICE S I1_minus_3() const { return D + (J_minus_1 + J_minus_1); }  // I₁ − 3

  template <class T>
  using rebind = CauchyGreenInvariants<T>;

  template <int Dim>
  PLIANT_HOST_DEVICE static CauchyGreenInvariants of(Tensor<S, Dim> const& h) {
    S const second = determinant_beyond_trace(h);
    return {dot(h, h) - (second + second), pliant::trace(h) + second};
  }
  template <class W, int Dim>
  PLIANT_HOST_DEVICE static Tensor<S, Dim> stress(CauchyGreenInvariants<W> const& w,
                                                  Tensor<S, Dim> const& h) {
    Tensor<S, Dim> const c = cofactor_less_identity(h);
    Tensor<S, Dim> p = (w.D + w.D) * (h - c) + w.J_minus_1 * c;
    for (int i = 0; i < Dim; ++i) p(i, i) = p(i, i) + S(w.J_minus_1);
    return p;
  }
};

/// Of the change of volume alone: J − 1 with J = det F.
template <class S>
struct VolumeChange {
  static constexpr int count = 1;
  S J_minus_1;  // J − 1

  template <class T>
  using rebind = VolumeChange<T>;

  template <int Dim>
  PLIANT_HOST_DEVICE static VolumeChange of(Tensor<S, Dim> const& h) {
    return {determinant_less_one(h)};
  }
  template <class W, int Dim>
  PLIANT_HOST_DEVICE static Tensor<S, Dim> stress(VolumeChange<W> const& w,
                                                  Tensor<S, Dim> const& h) {
    Tensor<S, Dim> p = w.J_minus_1 * cofactor_less_identity(h);
    for (int i = 0; i < Dim; ++i) p(i, i) = p(i, i) + S(w.J_minus_1);
    return p;
  }
};

/// Of the Green strain E = (FᵀF − I)/2: tr E and tr E².
template <class S>
struct GreenInvariants {
  static constexpr int count = 2;
  S trace;    // tr E
  S squares;  // tr E²

  template <class T>
  using rebind = GreenInvariants<T>;

  template <int Dim>
  PLIANT_HOST_DEVICE static Tensor<S, Dim> strain(Tensor<S, Dim> const& h) {
    Tensor<S, Dim> e;
    unroll<Dim>([&](auto i) PLIANT_INLINE {
      unroll<Dim - i>([&](auto d) PLIANT_INLINE {
        constexpr int j = i + d;
        S product = h(0, i) * h(0, j);
        for (int k = 1; k < Dim; ++k) product = product + h(k, i) * h(k, j);
        e(i, j) = (h(i, j) + h(j, i) + product) / 2;
        e(j, i) = e(i, j);
      });
    });
    return e;
  }
  template <int Dim>
  PLIANT_HOST_DEVICE static GreenInvariants of(Tensor<S, Dim> const& h) {
    Tensor<S, Dim> const e = strain(h);
    return {pliant::trace(e), dot(e, e)};
  }
  template <class W, int Dim>
  PLIANT_HOST_DEVICE static Tensor<S, Dim> stress(GreenInvariants<W> const& w,
                                                  Tensor<S, Dim> const& h) {
    Tensor<S, Dim> second = (w.squares + w.squares) * strain(h);  // second Piola-Kirchhoff
    for (int i = 0; i < Dim; ++i) second(i, i) = second(i, i) + S(w.trace);
    return second + h * second;  // F S
  }
};

}  // namespace pliant
