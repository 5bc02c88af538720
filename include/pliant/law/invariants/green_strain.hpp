#pragma once

#include <pliant/law/invariants/invariants.hpp>

namespace pliant {

/// The components of the Green strain E = (FᵀF − I)/2, each once, for laws of directions whose energy
/// is no function of FibreStretch or FibreStrain. In 2D the strain is plane: E₁₃ = E₂₃ = E₃₃ = 0.
template <class S, int Dim>
struct GreenStrain {
  static constexpr int count = Dim * (Dim + 1) / 2;
  S components[count];  // E₁₁ E₂₂ E₃₃ E₁₂ E₁₃ E₂₃, in 2D E₁₁ E₂₂ E₁₂

  template <class T>
  using rebind = GreenStrain<T, Dim>;
  PLIANT_HOST_DEVICE S& operator[](int k) { return components[k]; }
  PLIANT_HOST_DEVICE S const& operator[](int k) const { return components[k]; }
  PLIANT_HOST_DEVICE S const& operator()(int i, int j) const { return components[place(i, j)]; }

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
