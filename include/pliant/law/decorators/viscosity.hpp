#pragma once

#include <cmath>

#include <pliant/law/law.hpp>

// Viscosity as a decorator of an elastic law without values per element, in 3D and plane strain:
// Formulation<Hex8, Gauss<2>, Prony<NeoHookean>::law>. What flows is the second Piola-Kirchhoff stress
// S = F⁻¹ P, so that rotations are exact. The strain energy is that of the elastic law.
namespace pliant {

namespace detail {

/// The entries on and above the diagonal, row by row.
template <class S, int Dim>
PLIANT_HOST_DEVICE Vector<S, Dim*(Dim + 1) / 2> upper_part(Tensor<S, Dim> const& a) {
  Vector<S, Dim*(Dim + 1) / 2> v;
  for (int i = 0, k = 0; i < Dim; ++i)
    for (int j = i; j < Dim; ++j) v[k++] = a(i, j);
  return v;
}
/// F s, with s symmetric given by its upper part.
template <class S, class U, int Dim>
PLIANT_HOST_DEVICE Tensor<S, Dim> pushed_forward(Tensor<S, Dim> const& h,
                                                 Vector<U, Dim*(Dim + 1) / 2> const& upper) {
  Tensor<S, Dim> s;
  for (int i = 0, k = 0; i < Dim; ++i)
    for (int j = i; j < Dim; ++j) s(i, j) = s(j, i) = S(upper[k++]);
  return s + h * s;
}
/// S = F⁻¹ P, by its upper part.
template <class L, class S, int Dim>
PLIANT_HOST_DEVICE Vector<S, Dim*(Dim + 1) / 2> second_stress(L const& law,
                                                              Tensor<S, Dim> const& h) {
  auto const p = stress(law, h);
  auto c = cofactor_less_identity(h);
  for (int i = 0; i < Dim; ++i) c(i, i) = c(i, i) + S(1);
  return upper_part(reciprocal(S(1) + determinant_less_one(h)) * (transpose(c) * p));
}
template <class S, int Dim>
PLIANT_HOST_DEVICE Vector<S, Dim*(Dim + 1) / 2> green_strain(Tensor<S, Dim> const& h) {
  return upper_part(GreenInvariants<S>::strain(h));
}

}  // namespace detail

/// Kelvin-Voigt: a dashpot beside the elastic law L, S = S_L + η dE/dt. Under central differences the
/// rate lags half a step, which shortens the stable step.
template <template <class> class L>
struct KelvinVoigt {
  template <class T>
  struct law {
    static_assert(SolidLaw<L<double>>,
                  "KelvinVoigt takes laws of solids without values per element: not PlaneStress, "
                  "PerElement, or laws of fibres");
    L<T> elastic;
    T viscosity;  // η, Pa s: not negative

    static constexpr bool takes_inversion = pliant::takes_inversion<L<T>>;
    static constexpr bool depends_on_rate = true;

    void check() const {
      detail::check_parameters(elastic);
      detail::demand(viscosity >= 0, "Kelvin-Voigt's viscosity", viscosity,
                     "not be negative (in Pa s)");
    }

    template <int Dim>
    static constexpr int internal_variables = Dim * (Dim + 1) / 2;  // E

    /// A point with its internal variables.
    template <class S, int N>
    struct Point {
      L<T> elastic;
      T rate;  // η/Δt, Pa
      Vector<S, N> internal;

      template <class I>
      PLIANT_HOST_DEVICE auto energy(I const& i) const -> decltype(elastic.energy(i)) {
        return elastic.energy(i);
      }
      template <class V, int Dim>
      PLIANT_HOST_DEVICE Tensor<V, Dim> stress(Tensor<V, Dim> const& h) const {
        auto e = detail::green_strain(h);
        for (int k = 0; k < N; ++k) e[k] = rate * (e[k] - internal[k]);
        return pliant::stress(elastic, h) + detail::pushed_forward(h, e);
      }
    };
    /// What a time step makes of the law.
    struct Stepped {
      L<T> elastic;
      T rate;  // η/Δt, Pa; 0 where no time has passed

      template <class S, int N>
      PLIANT_HOST_DEVICE Point<S, N> after(Vector<S, N> const& internal) const {
        return {elastic, rate, internal};
      }
      template <class S, int N, int Dim>
      PLIANT_HOST_DEVICE Vector<S, N> advanced(Vector<S, N> const&, Tensor<S, Dim> const& h) const {
        return detail::green_strain(h);
      }
      template <class S, int Dim>
      PLIANT_HOST_DEVICE auto equilibrated(Tensor<S, Dim> const& h) const {
        return detail::green_strain(h);
      }
    };
    Stepped over(double step) const {
      return {elastic, step > 0 ? static_cast<T>(static_cast<double>(viscosity) / step) : T(0)};
    }
  };
};

/// A Prony series of Maxwell branches beside the elastic law L, which is what remains when all are
/// relaxed: S = S_L + Σ_i Q_i with dQ_i/dt + Q_i/τ_i = β_i dS_L/dt. With one branch the standard linear
/// solid. Integrated exactly for a stress S_L that is linear in time over a step (Taylor, Pister and
/// Goudreau 1970; Simo 1987). S_L = F⁻¹ P grows beyond bounds where J goes to 0, and is NaN there.
template <template <class> class L, int Branches = 1>
struct Prony {
  template <class T>
  struct law {
    static_assert(SolidLaw<L<double>>,
                  "Prony takes laws of solids without values per element: not PlaneStress, "
                  "PerElement, or laws of fibres");
    L<T> elastic;
    T share[Branches];       // β_i: stiffness of a branch over that of L, not negative
    T relaxation[Branches];  // τ_i, s: positive

    static constexpr bool takes_inversion = pliant::takes_inversion<L<T>>;

    void check() const {
      detail::check_parameters(elastic);
      for (T beta : share) detail::demand(beta >= 0, "a share of Prony", beta, "not be negative");
      for (T tau : relaxation)
        detail::demand(tau > 0, "a relaxation time of Prony", tau, "be positive (in s)");
    }

    template <int Dim>
    static constexpr int internal_variables =
        (Branches + 1) * Dim * (Dim + 1) / 2;  // S_L, then the Q_i

    /// A point with its internal variables.
    template <class S, int N>
    struct Point {
      L<T> elastic;
      T gain[Branches];
      Vector<S, N / (Branches + 1)> last, flowed;  // S_L before the step, Σ_i decay_i Q_i

      template <class I>
      PLIANT_HOST_DEVICE auto energy(I const& i) const -> decltype(elastic.energy(i)) {
        return elastic.energy(i);
      }
      template <class V, int Dim>
      PLIANT_HOST_DEVICE Tensor<V, Dim> stress(Tensor<V, Dim> const& h) const {
        T sum = gain[0];
        for (int b = 1; b < Branches; ++b) sum = sum + gain[b];
        auto s = detail::second_stress(elastic, h);
        for (int k = 0; k < N / (Branches + 1); ++k) s[k] = sum * (s[k] - last[k]) + flowed[k];
        return pliant::stress(elastic, h) + detail::pushed_forward(h, s);
      }
    };
    /// What a time step makes of the law.
    struct Stepped {
      L<T> elastic;
      T decay[Branches];  // e^(−Δt/τ)
      T gain[Branches];   // β (1 − e^(−Δt/τ)) τ/Δt

      template <class S, int N>
      PLIANT_HOST_DEVICE Point<S, N> after(Vector<S, N> const& internal) const {
        constexpr int n = N / (Branches + 1);
        Point<S, N> point{elastic, {}, {}, Vector<S, n>::zero()};
        for (int k = 0; k < n; ++k) point.last[k] = internal[k];
        for (int b = 0; b < Branches; ++b) {
          point.gain[b] = gain[b];
          for (int k = 0; k < n; ++k)
            point.flowed[k] = point.flowed[k] + decay[b] * internal[(b + 1) * n + k];
        }
        return point;
      }
      template <class S, int N, int Dim>
      PLIANT_HOST_DEVICE Vector<S, N> advanced(Vector<S, N> const& internal,
                                               Tensor<S, Dim> const& h) const {
        constexpr int n = N / (Branches + 1);
        auto const s = detail::second_stress(elastic, h);
        Vector<S, N> now;
        for (int k = 0; k < n; ++k) {
          now[k] = s[k];
          for (int b = 0; b < Branches; ++b)
            now[(b + 1) * n + k] =
                decay[b] * internal[(b + 1) * n + k] + gain[b] * (s[k] - internal[k]);
        }
        return now;
      }
      template <class S, int Dim>
      PLIANT_HOST_DEVICE auto equilibrated(Tensor<S, Dim> const& h) const {
        auto const s = detail::second_stress(elastic, h);
        auto now = Vector<S, internal_variables<Dim>>::zero();
        for (int k = 0; k < Dim * (Dim + 1) / 2; ++k) now[k] = s[k];
        return now;
      }
    };
    Stepped over(double step) const {
      Stepped stepped{elastic, {}, {}};
      for (int b = 0; b < Branches; ++b) {
        double const x = step / static_cast<double>(relaxation[b]);
        stepped.decay[b] = static_cast<T>(std::exp(-x));
        stepped.gain[b] =
            static_cast<T>(static_cast<double>(share[b]) * (x > 0 ? -std::expm1(-x) / x : 1.0));
      }
      return stepped;
    }
  };
};

}  // namespace pliant
