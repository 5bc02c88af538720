#pragma once

#include <pliant/formulation/coefficients.hpp>

namespace pliant {

/// The map from the reference cell to rest space at one quadrature point.
template <Element E, class S>
struct RestMap {
  Tensor<S, E::dim> cofactors;  // cof J = det J · J⁻ᵀ
  S volume;                     // det J
  S inverse_volume;

  template <class Table>
  PLIANT_HOST_DEVICE static RestMap at(Coefficients<E, S> const& rest, Table const& table, int q) {
    Tensor<S, E::dim> const j = rest.gradient(table, q);
    Tensor<S, E::dim> const c = cofactor(j);
    S det = j(0, 0) * c(0, 0);
    for (int k = 1; k < E::dim; ++k) det = det + j(0, k) * c(0, k);
    return {c, det, reciprocal(det)};
  }

  /// ∂v/∂X of a field at the same point.
  template <class Table>
  PLIANT_HOST_DEVICE Tensor<S, E::dim> gradient(Coefficients<E, S> const& v, Table const& table,
                                                int q) const {
    return inverse_volume * (v.gradient(table, q) * transpose(cofactors));
  }
};

}  // namespace pliant
