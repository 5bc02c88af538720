#pragma once

#include <pliant/element/quadratic_simplex.hpp>
#include <pliant/formulation/simplex_coefficients.hpp>
#include <pliant/formulation/tensor_coefficients.hpp>

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
    return of(jacobian(rest, table, q));
  }
  /// j: ∂X_i/∂ξ_k.
  PLIANT_HOST_DEVICE static RestMap of(Tensor<S, E::dim> const& j) {
    RestMap map{cofactor(j), j(0, 0), j(0, 0)};  // in place: copies would go through memory
    map.volume = j(0, 0) * map.cofactors(0, 0);
    for (int k = 1; k < E::dim; ++k) map.volume = map.volume + j(0, k) * map.cofactors(0, k);
    map.inverse_volume = reciprocal(map.volume);
    return map;
  }

  /// ∂v/∂X of a field at the same point.
  template <class Table>
  PLIANT_HOST_DEVICE Tensor<S, E::dim> gradient(Coefficients<E, S> const& v, Table const& table,
                                                int q) const {
    return gradient(v.gradient(table, q));
  }
  /// ∂v/∂X from ∂v_i/∂ξ_k.
  PLIANT_HOST_DEVICE Tensor<S, E::dim> gradient(Tensor<S, E::dim> const& slopes) const {
    return inverse_volume * (slopes * transpose(cofactors));
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
