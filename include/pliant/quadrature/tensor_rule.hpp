#pragma once

#include <pliant/math/power.hpp>
#include <pliant/quadrature/quadrature.hpp>

namespace pliant {

/// The points of a rule along a line, where it is the product of one rule with itself, direction 0 fastest; 0 where it
/// is not.
template <int Dim, int Count>
constexpr int points_per_direction(QuadratureRule<Dim, Count> const& rule) {
  int n = 1;
  while (power(n, Dim) < Count) ++n;
  if (power(n, Dim) != Count) return 0;
  for (int q = 0; q < Count; ++q)
    for (int k = 0; k < Dim; ++k)
      if (rule.points[q][k] != rule.points[q / power(n, k) % n][0]) return 0;
  return n;
}

/// A rule that is a product: the places along a line, and the weights of all points.
template <class Q, TensorCell Cell, class T>
struct ProductRule {
  using scalar = T;
  static constexpr auto rule = Q::template rule<Cell>();
  static constexpr int count = points_per_direction(rule);
  T place[count];
  T weight[rule.count];

  PLIANT_HOST_DEVICE static constexpr ProductRule make() {
    ProductRule product{};
    for (int p = 0; p < count; ++p) product.place[p] = static_cast<T>(rule.points[p][0]);
    for (int q = 0; q < rule.count; ++q) product.weight[q] = static_cast<T>(rule.weights[q]);
    return product;
  }
};

/// Whether a rule on a cell is a product.
template <class Q, class Cell>
inline constexpr bool is_tensor_rule = false;
template <class Q, TensorCell Cell>
inline constexpr bool is_tensor_rule<Q, Cell> = points_per_direction(Q::template rule<Cell>()) > 0;

}  // namespace pliant
