#pragma once

#include <pliant/formulation/point_stress.hpp>

// Stresses that a rotation of the body leaves alone, and the compliance that makes energies of them.
namespace pliant::detail {

/// The components of a symmetric tensor: the diagonal, then 12, or 12, 23, 13.
template <int Dim>
struct SymmetricComponents {
  static constexpr int count = Dim * (Dim + 1) / 2;
  PLIANT_HOST_DEVICE static constexpr int row(int c) { return c < Dim ? c : c == 4 ? 1 : 0; }
  PLIANT_HOST_DEVICE static constexpr int column(int c) {
    return c < Dim ? c : c == 3 && Dim == 3 ? 1 : Dim - 1;
  }
};

template <class S, int Dim>
PLIANT_HOST_DEVICE Vector<S, SymmetricComponents<Dim>::count> components_of(
    Tensor<S, Dim> const& t) {
  using C = SymmetricComponents<Dim>;
  Vector<S, C::count> v;
  for (int c = 0; c < C::count; ++c)
    v[c] = c < Dim
               ? t(c, c)
               : builtin_scalar<S>(0.5) * (t(C::row(c), C::column(c)) + t(C::column(c), C::row(c)));
  return v;
}

/// F⁻¹ of F = I + H; NaN where det F ≤ 0.
template <class S, int Dim>
PLIANT_HOST_DEVICE Tensor<S, Dim> inverse_deformation(Tensor<S, Dim> const& h) {
  auto c = cofactor_less_identity(h);
  for (int i = 0; i < Dim; ++i) c(i, i) = c(i, i) + S(1);
  return reciprocal(positive_or_nan(S(1) + determinant_less_one(h))) * transpose(c);
}

/// The second Piola-Kirchhoff stress S = F⁻¹ P, conjugate to Green's strain; under laws of small strain P.
template <class L, class S, int Dim>
PLIANT_HOST_DEVICE auto material_stress(L const&, Tensor<S, Dim> const& h,
                                        Tensor<S, Dim> const& p) {
  if constexpr (OfSmallStrain<L>)
    return components_of(p);
  else
    return components_of(inverse_deformation(h) * p);
}

/// The moduli ∂S/∂E at H, by columns of unit strain (shear strains as γ = 2 E_ij), factorised as L D Lᵀ.
template <class S, int Dim>
class Compliance {
 public:
  static constexpr int count = SymmetricComponents<Dim>::count;

  template <class L>
  PLIANT_HOST_DEVICE static Compliance of(L const& law, Tensor<S, Dim> const& h) {
    using C = SymmetricComponents<Dim>;
    using T = builtin_scalar<S>;
    Compliance c;
    auto inverse = Tensor<S, Dim>::identity();
    auto second = Tensor<S, Dim>::zero();
    if constexpr (!OfSmallStrain<L>) {
      inverse = inverse_deformation(h);
      second = inverse * stress(law, h);
    }
    for (int k = 0; k < count; ++k) {
      auto strain = Tensor<S, Dim>::zero();
      if (k < Dim) {
        strain(k, k) = S(1);
      } else {
        strain(C::row(k), C::column(k)) = S(T(0.5));
        strain(C::column(k), C::row(k)) = S(T(0.5));
      }
      // With dF = F⁻ᵀ dE: sym(Fᵀ dF) = dE, and dS = F⁻¹ (dP − dF S).
      auto const df = transpose(inverse) * strain;
      auto const dp = stress_tangent_product(law, h, df);
      auto const ds = components_of(inverse * (dp - df * second));
      for (int i = 0; i < count; ++i) c.factors_(i, k) = ds[i];
    }
    c.factorise();
    return c;
  }

  /// ½ Δσ : C⁻¹ : Δσ, J/m³. Where the law has lost stability the sizes of the pivots count, so that no energy is
  /// negative.
  PLIANT_HOST_DEVICE S energy_density(Vector<S, count> s) const {
    S sum(0);
    for (int k = 0; k < count; ++k) {
      for (int j = 0; j < k; ++j) s[k] = s[k] - factors_(k, j) * s[j];
      sum = sum + s[k] * s[k] / abs(factors_(k, k));
    }
    return builtin_scalar<S>(0.5) * sum;
  }

 private:
  PLIANT_HOST_DEVICE void factorise() {
    for (int k = 0; k < count; ++k)
      for (int i = k + 1; i < count; ++i) {
        S const factor = factors_(i, k) / factors_(k, k);
        for (int j = k + 1; j <= i; ++j) factors_(i, j) = factors_(i, j) - factor * factors_(j, k);
      }
    for (int k = 0; k < count; ++k)
      for (int i = k + 1; i < count; ++i) factors_(i, k) = factors_(i, k) / factors_(k, k);
  }
  Tensor<S, count> factors_;  // the lower half
};

}  // namespace pliant::detail
