#pragma once

#include <deal.II/base/tensor.h>
#include <deal.II/base/vectorization.h>

#include <pliant/openmp/pack_functions.hpp>

// First Piola-Kirchhoff stresses and their directional derivatives by hand, as deal.II's users write them.
namespace pliant::bench {

/// A number of several elements side by side, as deal.II has it.
using Lanes = dealii::VectorizedArray<double, simd_bytes / 8>;
using Gradient = dealii::Tensor<2, 3, Lanes>;

/// deal.II takes logarithms lane by lane; this spares it that.
inline Lanes log_of(Lanes const& x) {
  Pack<double, Lanes::size()> p;
  __builtin_memcpy(&p.v, &x.data, sizeof(p.v));
  p = log(p);
  Lanes y;
  __builtin_memcpy(&y.data, &p.v, sizeof(p.v));
  return y;
}

inline Gradient deformation_gradient(Gradient const& h) {
  Gradient f = h;
  for (unsigned i = 0; i < 3; ++i) f[i][i] += 1.0;
  return f;
}

/// S = λ tr E I + 2μ E, E = (H + Hᵀ + HᵀH)/2, P = F S.
struct PeerSaintVenantKirchhoff {
  double lambda, mu;

  Gradient stress(Gradient const& h) const { return deformation_gradient(h) * second(h); }
  /// δH S + F δS, with 2 δE = FᵀδH + δHᵀF.
  Gradient derivative(Gradient const& h, Gradient const& dh) const {
    Gradient const f = deformation_gradient(h), product = dealii::transpose(f) * dh;
    return dh * second(h) +
           f * of_strain([&](unsigned i, unsigned j) { return product[i][j] + product[j][i]; });
  }

 private:
  Gradient second(Gradient const& h) const {
    return of_strain([&](unsigned i, unsigned j) {
      return h[i][j] + h[j][i] + (h[0][i] * h[0][j] + h[1][i] * h[1][j] + h[2][i] * h[2][j]);
    });
  }
  /// From the entries of 2E below its diagonal and on it.
  template <class TwiceStrain>
  Gradient of_strain(TwiceStrain const& twice) const {
    Gradient s;
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned j = 0; j <= i; ++j) s[i][j] = s[j][i] = twice(i, j);
    Lanes const pressure = (0.5 * lambda) * (s[0][0] + s[1][1] + s[2][2]);
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned j = 0; j < 3; ++j) s[i][j] = mu * s[i][j];
    for (unsigned i = 0; i < 3; ++i) s[i][i] += pressure;
    return s;
  }
};

/// P = μ (F − F⁻ᵀ) + λ ln J F⁻ᵀ.
struct PeerNeoHookean {
  double lambda, mu;

  Gradient stress(Gradient const& h) const {
    Gradient const f = deformation_gradient(h);
    Lanes j;
    Gradient const inverse = inverse_transposed(f, j);
    return mu * f + (lambda * log_of(j) - mu) * inverse;
  }
  /// μ δF + (μ − λ ln J) F⁻ᵀ δFᵀ F⁻ᵀ + λ (F⁻ᵀ : δF) F⁻ᵀ.
  Gradient derivative(Gradient const& h, Gradient const& dh) const {
    Lanes j;
    Gradient const g = inverse_transposed(deformation_gradient(h), j);
    Lanes const trace = dealii::scalar_product(g, dh);
    Lanes const factor = mu - lambda * log_of(j);
    return mu * dh + factor * (g * (dealii::transpose(dh) * g)) + (lambda * trace) * g;
  }

 private:
  static Gradient inverse_transposed(Gradient const& f, Lanes& j) {
    Gradient c;
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned k = 0; k < 3; ++k) {
        unsigned const i1 = (i + 1) % 3, i2 = (i + 2) % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
        c[i][k] = f[i1][k1] * f[i2][k2] - f[i1][k2] * f[i2][k1];
      }
    j = f[0][0] * c[0][0] + f[0][1] * c[0][1] + f[0][2] * c[0][2];
    return (1.0 / j) * c;
  }
};

}  // namespace pliant::bench
