#pragma once

#include <pliant/formulation/kinematics.hpp>

// What a quadrature point adds to the stiffness of its element.
namespace pliant::detail {

/// det J ∂N_b/∂X_l at point q, (dim, nodes).
template <Element E, class Map, class Table>
PLIANT_HOST_DEVICE auto rest_gradients(Map const& map, Table const& table, int q) {
  using S = std::remove_cvref_t<decltype(map.volume)>;
  using T = builtin_scalar<S>;
  Matrix<S, E::dim, E::nodes> gradient;
  for (int l = 0; l < E::dim; ++l)
    for (int b = 0; b < E::nodes; ++b) {
      gradient(l, b) = map.cofactors(l, 0) * T(table.gradient[q][b][0]);
      for (int m = 1; m < E::dim; ++m)
        gradient(l, b) = gradient(l, b) + map.cofactors(l, m) * T(table.gradient[q][b][m]);
    }
  return gradient;
}

/// Adds Σ_jl ∂N_a/∂X_j ∂P_ij/∂H_kl ∂N_b/∂X_l to the rows (a, i) and columns (b, k) of the upper half, by `change`, the
/// change of the stress along a gradient, which is symmetric. `weight` is that of the point over det J.
template <Element E, class S, class Change>
PLIANT_HOST_DEVICE void add_point_stiffness(Tensor<S, E::nodes * E::dim>& k,
                                            Matrix<S, E::dim, E::nodes> const& gradient,
                                            Change const& change, S const& weight) {
  constexpr int dim = E::dim, size = E::nodes * dim;
  Matrix<S, dim, size> pull[dim];  // of stress i, j: Σ_l ∂P_ij/∂H_kl ∂N_b/∂X_l
  for (int direction = 0; direction < dim; ++direction) {
    Tensor<S, dim> tangent[dim];  // ∂P/∂H_(direction)l
    for (int l = 0; l < dim; ++l) {
      auto dh = Tensor<S, dim>::zero();
      dh(direction, l) = weight;
      tangent[l] = change(dh);
    }
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j)
        for (int b = 0; b < E::nodes; ++b) {
          S sum = tangent[0](i, j) * gradient(0, b);
          for (int l = 1; l < dim; ++l) sum = sum + tangent[l](i, j) * gradient(l, b);
          pull[i](j, dim * b + direction) = sum;
        }
  }
  for (int a = 0; a < E::nodes; ++a)
    for (int i = 0; i < dim; ++i)
      for (int column = dim * a; column < size; ++column) {
        S sum = gradient(0, a) * pull[i](0, column);
        for (int j = 1; j < dim; ++j) sum = sum + gradient(j, a) * pull[i](j, column);
        k(dim * a + i, column) = k(dim * a + i, column) + sum;
      }
}

/// Makes the lower half that of a symmetric matrix.
template <class S, int N>
PLIANT_HOST_DEVICE void mirror_upper_half(Tensor<S, N>& k) {
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < i; ++j) k(i, j) = k(j, i);
}

}  // namespace pliant::detail
