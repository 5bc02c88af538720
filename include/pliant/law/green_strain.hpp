#pragma once

#include <pliant/law/invariants.hpp>

namespace pliant {

/// The components of the Green strain E = (FᵀF − I)/2, each once: what laws of directions are
/// written in. In 2D the strain is plane: E₁₃ = E₂₃ = E₃₃ = 0.
template <class S, int Dim>
struct GreenStrain {
  static constexpr int count = Dim * (Dim + 1) / 2;
  S components[count];  // E₁₁ E₂₂ E₃₃ E₁₂ E₁₃ E₂₃, in 2D E₁₁ E₂₂ E₁₂

  template <class T>
  using rebind = GreenStrain<T, Dim>;
  PLIANT_HOST_DEVICE S& operator[](int k) { return components[k]; }
  PLIANT_HOST_DEVICE S const& operator[](int k) const { return components[k]; }
  PLIANT_HOST_DEVICE S const& operator()(int i, int j) const { return components[place(i, j)]; }

  PLIANT_HOST_DEVICE S trace() const {
    S sum = components[0];
    for (int i = 1; i < Dim; ++i) sum = sum + components[i];
    return sum;
  }
  /// E:E
  PLIANT_HOST_DEVICE S squares() const {
    S normal = square(components[0]), shear = square(components[Dim]);
    for (int k = 1; k < Dim; ++k) normal = normal + square(components[k]);
    for (int k = Dim + 1; k < count; ++k) shear = shear + square(components[k]);
    return normal + shear + shear;
  }
  /// E f, its components in the 2 or 3 dimensions.
  template <class C>
  PLIANT_HOST_DEVICE Vector<S, Dim> times(Vector<C, 3> const& f) const {
    Vector<S, Dim> product;
    for (int i = 0; i < Dim; ++i) {
      product[i] = (*this)(i, 0) * f[0];
      for (int j = 1; j < Dim; ++j) product[i] = product[i] + (*this)(i, j) * f[j];
    }
    return product;
  }
  /// f·v
  template <class C>
  PLIANT_HOST_DEVICE static S along(Vector<C, 3> const& f, Vector<S, Dim> const& v) {
    S sum = v[0] * f[0];
    for (int i = 1; i < Dim; ++i) sum = sum + v[i] * f[i];
    return sum;
  }

  PLIANT_HOST_DEVICE static GreenStrain of(Tensor<S, Dim> const& h) {
    Tensor<S, Dim> const strain = GreenInvariants<S>::strain(h);
    GreenStrain e;
    for (int i = 0; i < Dim; ++i)
      for (int j = i; j < Dim; ++j) e.components[place(i, j)] = strain(i, j);
    return e;
  }
  /// P = F S with the second Piola-Kirchhoff stress S = ∂W/∂E; E₁₂ stands for E₂₁ too.
  PLIANT_HOST_DEVICE static Tensor<S, Dim> stress(GreenStrain const& w, Tensor<S, Dim> const& h) {
    Tensor<S, Dim> second;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) second(i, j) = i == j ? w(i, i) : w(i, j) / 2;
    return second + h * second;
  }

 private:
  PLIANT_HOST_DEVICE static constexpr int place(int i, int j) {
    return i == j ? i : Dim - 1 + i + j;
  }
};

}  // namespace pliant
