#pragma once

#include <pliant/element/element.hpp>
#include <pliant/math/power.hpp>

namespace pliant {

/// Points and weights on a cell; the weights add up to the cell's volume.
template <int Dim, int Count>
struct QuadratureRule {
  static constexpr int dim = Dim, count = Count;
  double points[Count][Dim];
  double weights[Count];
};

/// Gives a rule for a cell, constexpr.
template <class Q, class Cell>
concept QuadratureOn = requires {
  { Q::template rule<Cell>().weights[0] } -> std::convertible_to<double>;
  requires decltype(Q::template rule<Cell>())::dim == Cell::dim;
};

/// The values of an element's shape functions, their gradients and the weights at the points of a
/// rule, computed by the compiler.
template <Element E, class Q, class T>
struct Tabulation {
  static constexpr int count = decltype(Q::template rule<typename E::cell>())::count;
  static constexpr int exponents = E::degree + 1;  // of a direction: 0, 1, ... degree
  T monomial[count][power(exponents, E::dim)];     // Π ξ_k^b_k at Σ b_k exponentsᵏ
  T shape[count][E::nodes];
  T gradient[count][E::nodes][E::dim];
  T weight[count];
};

template <Element E, class Q, class T>
PLIANT_HOST_DEVICE constexpr Tabulation<E, Q, T> tabulate() {
  constexpr auto rule = Q::template rule<typename E::cell>();
  Tabulation<E, Q, T> table{};
  for (int q = 0; q < rule.count; ++q) {
    Vector<double, E::dim> xi{};
    for (int k = 0; k < E::dim; ++k) xi[k] = rule.points[q][k];
    for (int b = 0; b < power(table.exponents, E::dim); ++b) {
      double product = 1;
      for (int k = 0; k < E::dim; ++k)
        for (int times = b / power(table.exponents, k) % table.exponents; times > 0; --times)
          product *= xi[k];
      table.monomial[q][b] = static_cast<T>(product);
    }
    auto const shape = E::shape(xi);
    auto const gradient = shape_gradient<E>(xi);
    for (int a = 0; a < E::nodes; ++a) {
      table.shape[q][a] = static_cast<T>(shape[a]);
      for (int k = 0; k < E::dim; ++k) table.gradient[q][a][k] = static_cast<T>(gradient(a, k));
    }
    table.weight[q] = static_cast<T>(rule.weights[q]);
  }
  return table;
}

}  // namespace pliant
