#pragma once

#include <pliant/element/quadratic_simplex.hpp>
#include <pliant/formulation/coefficients.hpp>

namespace pliant {

/// Whether the map from the cell to rest space varies inside the elements of a table.
enum class Geometry {
  isoparametric,  ///< as the element's shape functions have it
  straight  ///< Tri6 and Tet10 whose edges are straight, with their nodes in the middle: constant
};

/// The map from the reference cell to rest space at one quadrature point.
template <Element E, class S, Geometry G = Geometry::isoparametric>
struct RestMap {
  Tensor<S, E::dim> cofactors;  // cof J = det J · J⁻ᵀ
  S volume;                     // det J
  S inverse_volume;

  template <class Table>
  PLIANT_HOST_DEVICE static RestMap at(Coefficients<E, S> const& rest, Table const& table, int q) {
    Tensor<S, E::dim> const j = jacobian(rest, table, q);
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

 private:
  template <class Table>
  PLIANT_HOST_DEVICE static Tensor<S, E::dim> jacobian(Coefficients<E, S> const& rest,
                                                       Table const& table, int q) {
    if constexpr (G == Geometry::straight) {
      static_assert(CurvedSimplex<E>, "only Tri6 and Tet10 tell straight from curved");
      return transpose(rest.to_corners());
    } else {
      return rest.gradient(table, q);
    }
  }
};

}  // namespace pliant
