#pragma once

#include <pliant/formulation/kinematics.hpp>
#include <pliant/formulation/scheme/one_point.hpp>

namespace pliant {

/// A law with the shear modulus at rest (Pa) that hourglass control scales with.
template <class L, class T>
struct WithModulus {
  L law;
  T modulus;
};

/// ∂V/∂X_b of a multilinear cell's volume V by the coefficients of its monomials Π_{k∈b} ξ_k: with it,
/// ∫ ∂v/∂X dV = Σ_b v_b ⊗ ∂V/∂X_b, which the middle of the cell alone gives only where sides are
/// parallel (Flanagan and Belytschko 1981).
template <Multilinear E, class S>
struct MeanGradient {
  static constexpr int dim = E::dim;
  Vector<S, dim> slope[E::nodes];  // by b; zero for 1 and ξηζ
  S volume;

  PLIANT_HOST_DEVICE static MeanGradient of(Coefficients<E, S> const& x) {
    using T = builtin_scalar<S>;
    MeanGradient mean;
    for (auto& v : mean.slope) v = Vector<S, dim>::zero();
    Vector<S, dim> c[E::nodes];
    for (int b = 0; b < E::nodes; ++b)
      for (int i = 0; i < dim; ++i) c[b][i] = x.c[b][i];
    if constexpr (dim == 2) {
      mean.slope[1] = {{{c[2][1]}, {-c[2][0]}}};
      mean.slope[2] = {{{-c[1][1]}, {c[1][0]}}};
    } else {
      T const third = T(1) / T(3);
      unroll<3>([&](auto k) PLIANT_INLINE {  // directions p, q, r in turn
        constexpr int p = 1 << k, q = 1 << (k + 1) % 3, r = 1 << (k + 2) % 3;
        mean.slope[p] = cross(c[q], c[r]) + third * cross(c[p | q], c[p | r]);
        mean.slope[p | q] = third * (cross(c[q], c[q | r]) + cross(c[p | r], c[p]) +
                                     third * (cross(c[p | q], c[7]) + cross(c[7], c[p | q])));
      });
    }
    S sum = S(0);
    for (int b = 1; b < E::nodes; ++b) sum = sum + dot(c[b], mean.slope[b]);
    T const size = T(E::cell::volume);
    mean.volume = (size / T(dim)) * sum;
    for (auto& v : mean.slope) v = size * v;
    return mean;
  }

  /// The mean of ∂v/∂X.
  PLIANT_HOST_DEVICE Tensor<S, dim> operator()(Coefficients<E, S> const& v) const {
    auto sum = Tensor<S, dim>::zero();
    for (int b = 1; b < E::nodes; ++b)
      for (int i = 0; i < dim; ++i)
        for (int k = 0; k < dim; ++k) sum(i, k) = sum(i, k) + v.c[b][i] * slope[b][k];
    return reciprocal(volume) * sum;
  }
  /// Adds the transpose: the coefficients that t, an integral over the element, pulls at.
  PLIANT_HOST_DEVICE void add_transpose(Tensor<S, dim> const& t, Coefficients<E, S>& f) const {
    S const inverse = reciprocal(volume);
    for (int b = 1; b < E::nodes; ++b)
      for (int i = 0; i < dim; ++i)
        for (int k = 0; k < dim; ++k) f.c[b][i] = f.c[b][i] + inverse * t(i, k) * slope[b][k];
  }
};

/// The mean deformation of a multilinear cell, and stiffness against what it does not see: of the
/// field's coefficients at ξη, ηζ, ... the part that a uniform state does not explain, q_b = u_b − H X_b,
/// has the energy ½ κ V Σ_b g_b |q_b|². With κ = 5μ/2, near Young's modulus, and g_b the harmonic mean of
/// |∂ξ_k/∂X|² over b times the mean square of the other factor of its slope, a rectangle bends about as
/// it should, whatever its shape. Uniform states and rotations have none of it.
template <class F>
struct HourglassControl {
  using E = typename F::element;
  static_assert(Multilinear<E>, "OnePoint is a quadrature for Quad4 and Hex8");
  static constexpr int dim = E::dim;

  template <class T, class L, class S>
  PLIANT_HOST_DEVICE static S energy(WithModulus<L, T> const& law, Nodal<E, S> const& rest,
                                     Nodal<E, S> const& u) {
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
    auto const mean = MeanGradient<E, S>::of(x);
    auto const h = mean(v);
    auto const f = control(law.modulus, mean, x, v, h);
    S work(0);  // of the control, which is linear in u
    for (int b = 1; b < E::nodes; ++b)
      for (int i = 0; i < dim; ++i) work = work + f.c[b][i] * v.c[b][i];
    return mean.volume * energy_density(law.law, h) - work / S(2);
  }
  template <class T, class L, class S>
  PLIANT_HOST_DEVICE static Nodal<E, S> force(WithModulus<L, T> const& law, Nodal<E, S> const& rest,
                                              Nodal<E, S> const& u) {
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
    auto const mean = MeanGradient<E, S>::of(x);
    auto const h = mean(v);
    auto f = control(law.modulus, mean, x, v, h);
    mean.add_transpose(-mean.volume * stress(law.law, h), f);
    return f.per_node();
  }
  template <class T, class L, class S>
  PLIANT_HOST_DEVICE static Nodal<E, S> tangent_product(WithModulus<L, T> const& law,
                                                        Nodal<E, S> const& rest,
                                                        Nodal<E, S> const& u,
                                                        Nodal<E, S> const& du) {
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u),
               dv = Coefficients<E, S>::of(du);
    auto const mean = MeanGradient<E, S>::of(x);
    auto const h = mean(v), dh = mean(dv);
    auto df = control(law.modulus, mean, x, dv, dh);
    mean.add_transpose(-mean.volume * stress_tangent_product(law.law, h, dh), df);
    return df.per_node();
  }

 private:
  template <class T, class S>
  PLIANT_HOST_DEVICE static Coefficients<E, S> control(T modulus, MeanGradient<E, S> const& mean,
                                                       Coefficients<E, S> const& x,
                                                       Coefficients<E, S> const& v,
                                                       Tensor<S, dim> const& h) {
    using R = builtin_scalar<S>;
    S flatness[dim];  // 1/|∂ξ_k/∂X|²
    S const squared_volume = square(mean.volume);
    for (int k = 0; k < dim; ++k)
      flatness[k] = squared_volume / dot(mean.slope[1 << k], mean.slope[1 << k]);
    S const scale = (modulus * R(2.5 * OnePoint::share)) * mean.volume;
    auto f = Coefficients<E, S>::zero();
    auto shared = Tensor<S, dim>::zero();  // what H hands back
    unroll<E::nodes>([&](auto b) PLIANT_INLINE {
      constexpr int order = std::popcount(static_cast<unsigned>(int{b}));
      if constexpr (order >= 2) {
        S flat = S(0);
        for (int k = 0; k < dim; ++k)
          if (b >> k & 1) flat = flat + flatness[k];
        S const stiffness = scale * R(order == 2 ? 2.0 / 3 : 3.0 / 9) / flat;
        for (int i = 0; i < dim; ++i) {
          S q = v.c[b][i];
          for (int k = 0; k < dim; ++k) q = q - h(i, k) * x.c[b][k];
          S const pull = stiffness * q;
          f.c[b][i] = -pull;
          for (int k = 0; k < dim; ++k) shared(i, k) = shared(i, k) + pull * x.c[b][k];
        }
      }
    });
    mean.add_transpose(shared, f);
    return f;
  }
};

}  // namespace pliant
