#pragma once

#include <array>

#include <pliant/formulation/point_stress.hpp>
#include <pliant/math/spectrum.hpp>

// Whether a law lets waves travel: see Ogden, Non-Linear Elastic Deformations, 1984, section 6.2.7.
namespace pliant {

namespace detail {
/// Directions that are looked at: in the plane every π/16, in space along edges, face and body diagonals of a cube.
template <int Dim>
constexpr auto wave_directions() {
  if constexpr (Dim == 2) {
    constexpr double c1 = 0.98078528040323045, s1 = 0.19509032201612825, c2 = 0.92387953251128676,
                     s2 = 0.38268343236508977, c3 = 0.83146961230254524, s3 = 0.55557023301960218,
                     c4 = 0.70710678118654752;
    return std::array<std::array<double, 2>, 16>{{{1, 0},
                                                  {c1, s1},
                                                  {c2, s2},
                                                  {c3, s3},
                                                  {c4, c4},
                                                  {s3, c3},
                                                  {s2, c2},
                                                  {s1, c1},
                                                  {0, 1},
                                                  {-s1, c1},
                                                  {-s2, c2},
                                                  {-s3, c3},
                                                  {-c4, c4},
                                                  {-c3, s3},
                                                  {-c2, s2},
                                                  {-c1, s1}}};
  } else {
    constexpr double d = 0.70710678118654752, b = 0.57735026918962576;
    return std::array<std::array<double, 3>, 13>{{{1, 0, 0},
                                                  {0, 1, 0},
                                                  {0, 0, 1},
                                                  {d, d, 0},
                                                  {d, -d, 0},
                                                  {d, 0, d},
                                                  {d, 0, -d},
                                                  {0, d, d},
                                                  {0, d, -d},
                                                  {b, b, b},
                                                  {b, b, -b},
                                                  {b, -b, b},
                                                  {-b, b, b}}};
  }
}

template <class S, int Dim>
PLIANT_HOST_DEVICE S least_eigenvalue(Tensor<S, Dim> const& q) {
  using T = builtin_scalar<S>;
  if constexpr (Dim == 2) {
    S const mean = T(0.5) * (q(0, 0) + q(1, 1)), gap = T(0.5) * (q(0, 0) - q(1, 1));
    return mean - sqrt(square(gap) + square(T(0.5) * (q(0, 1) + q(1, 0))));
  } else {
    auto const values = Spectrum<S, Dim>::of(q).values;
    return minimum(values[0], minimum(values[1], values[2]));
  }
}

/// Whether a symmetric tensor has positive eigenvalues alone, by the pivots of Gauss' elimination; NaN has not.
template <class T, int Dim>
PLIANT_HOST_DEVICE bool is_positive_definite(Tensor<T, Dim> q) {
  bool holds = true;
  for (int k = 0; k < Dim; ++k) {
    holds = holds && T(0) < q(k, k);
    for (int i = k + 1; i < Dim; ++i)
      for (int j = i; j < Dim; ++j) q(i, j) = q(i, j) - q(k, i) / q(k, k) * q(k, j);
  }
  return holds;
}

/// visit(Q) with the acoustic tensor Q_ik(N) = ∂P_iJ/∂F_kL N_J N_L of each direction N that is looked at.
template <class L, class S, int Dim, class Visit>
PLIANT_HOST_DEVICE void for_each_acoustic_tensor(L const& law, Tensor<S, Dim> const& h,
                                                 Visit const& visit) {
  using T = builtin_scalar<S>;
  static constexpr auto directions = wave_directions<Dim>();
  // By dual numbers of several components: what does not depend on the direction, such as principal stretches, is found
  // once for them.
  Tensor<Dual<S, Dim>, Dim> along[Dim];  // P, derivative[L] of the k-th is ∂P/∂F_kL
  for (int k = 0; k < Dim; ++k) {
    Tensor<Dual<S, Dim>, Dim> variables;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) {
        variables(i, j).value = h(i, j);
        variables(i, j).derivative[j] = S(i == k ? 1 : 0);
      }
    along[k] = stress(law, variables);
  }
  for (auto const& direction : directions) {
    T n[Dim];
    for (int j = 0; j < Dim; ++j) n[j] = static_cast<T>(direction[static_cast<std::size_t>(j)]);
    auto q = Tensor<S, Dim>::zero();
    for (int j = 0; j < Dim; ++j)
      for (int l = 0; l < Dim; ++l) {
        T const both = n[j] * n[l];
        for (int i = 0; i < Dim; ++i)
          for (int k = i; k < Dim; ++k) q(i, k) = q(i, k) + along[k](i, j).derivative[l] * both;
      }
    for (int i = 0; i < Dim; ++i)
      for (int k = 0; k < i; ++k) q(i, k) = q(k, i);
    visit(q);
  }
}
}  // namespace detail

/// The least eigenvalue, Pa, of the acoustic tensor Q_ik(N) = ∂P_iJ/∂F_kL N_J N_L over directions N at rest; of those
/// that are looked at (16 in the plane, 13 in space), so that a narrow cone may be missed. Where it is not positive the
/// law has lost strong ellipticity: short waves grow instead of travelling. NaN where the law has no tangent.
template <class L, class S, int Dim>
PLIANT_HOST_DEVICE S least_acoustic_eigenvalue(L const& law, Tensor<S, Dim> const& h) {
  S least(std::numeric_limits<builtin_scalar<S>>::max());
  detail::for_each_acoustic_tensor(law, h, [&](Tensor<S, Dim> const& q) {
    least = minimum(least, detail::least_eigenvalue(q));
  });
  return least;
}

/// Whether least_acoustic_eigenvalue is positive, without finding it.
template <class L, class T, int Dim>
PLIANT_HOST_DEVICE bool is_strongly_elliptic_at(L const& law, Tensor<T, Dim> const& h) {
  bool holds = true;
  detail::for_each_acoustic_tensor(
      law, h, [&](Tensor<T, Dim> const& q) { holds = holds && detail::is_positive_definite(q); });
  return holds;
}

/// Whether the law of a formulation is strongly elliptic at all points of an element, under their own deformations.
template <class F, class L, class S>
PLIANT_HOST_DEVICE bool is_strongly_elliptic(L const& law,
                                             Nodal<typename F::element, S> const& rest,
                                             Nodal<typename F::element, S> const& u) {
  if constexpr (detail::OfSmallStrain<std::remove_cvref_t<decltype(point_law(law, 0))>>) {
    return true;  // its tangent is that at rest
  } else {
    bool holds = true;
    for_each_point_of<F>(rest, u, [&](int q, S const&, Tensor<S, F::dim> const& h) {
      holds = holds && is_strongly_elliptic_at(point_law(law, q), h);
    });
    return holds;
  }
}

}  // namespace pliant
