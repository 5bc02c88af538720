#pragma once

#include <pliant/formulation/formulation.hpp>
#include <pliant/quadrature/gauss.hpp>

namespace pliant::detail {

/// How much of a stress field an element's points tell with an order more than the others: its mean on linear
/// elements, and on quadratic ones the polynomial of degree one (of degree one in each direction on
/// tensor cells) nearest to it, which goes through the superconvergent points of Barlow (1976) and Zienkiewicz &
/// Zhu (1992).
template <Element E, int Points>
struct RecoveredPolynomial {
  static constexpr int dim = E::dim;
  static constexpr int wanted = E::degree == 1                 ? 1
                                : TensorCell<typename E::cell> ? 1 << dim
                                                               : 1 + dim;
  static constexpr int terms = Points >= wanted ? wanted : Points > dim ? 1 + dim : 1;

  /// Term m is Π ξ_k over these directions, as bits.
  PLIANT_HOST_DEVICE static constexpr int directions(int m) {
    return terms == 1 + dim ? (m == 0 ? 0 : 1 << (m - 1)) : m;
  }
  /// The term ξ_k.
  PLIANT_HOST_DEVICE static constexpr int linear_term(int k) {
    return terms == 1 + dim ? 1 + k : 1 << k;
  }
  PLIANT_HOST_DEVICE static constexpr double term(int m, Vector<double, dim> const& xi) {
    double product = 1;
    for (int k = 0; k < dim; ++k) product *= (directions(m) >> k & 1) != 0 ? xi[k] : 1;
    return product;
  }
};

/// The polynomial by the values at the points of a rule, and its values there and at nodes.
template <Element E, class Q, class T, int Terms>
struct FitTable {
  static constexpr int count = decltype(Q::template rule<typename E::cell>())::count;
  T fit[Terms][count];                // coefficients from values
  T term[count][Terms];               // at the points
  T at_node[E::nodes][Terms];         // at the nodes
  T corner[count][E::cell::corners];  // the functions that are one at a corner, at the points
};

/// Least squares with the rule's weights, by the normal equations.
template <Element E, class Q, class T, class Polynomial>
PLIANT_HOST_DEVICE constexpr auto fit_table() {
  constexpr int terms = Polynomial::terms, dim = E::dim;
  using Table = FitTable<E, Q, T, terms>;
  constexpr auto rule = Q::template rule<typename E::cell>();
  double right[terms][terms + Table::count]{};
  Table table{};
  for (int q = 0; q < Table::count; ++q) {
    Vector<double, dim> xi{};
    for (int k = 0; k < dim; ++k) xi[k] = rule.points[q][k];
    for (int m = 0; m < terms; ++m) {
      double const own = Polynomial::term(m, xi);
      table.term[q][m] = static_cast<T>(own);
      right[m][terms + q] = rule.weights[q] * own;
      for (int n = 0; n < terms; ++n)
        right[m][n] += rule.weights[q] * own * Polynomial::term(n, xi);
    }
    auto const corner = E::cell::linear(xi);
    for (int c = 0; c < E::cell::corners; ++c) table.corner[q][c] = static_cast<T>(corner[c]);
  }
  for (int m = 0; m < terms; ++m) {  // Gauss and Jordan; the matrix is symmetric and definite
    double const pivot = right[m][m];
    for (int j = 0; j < terms + Table::count; ++j) right[m][j] /= pivot;
    for (int n = 0; n < terms; ++n)
      if (n != m) {
        double const factor = right[n][m];
        for (int j = 0; j < terms + Table::count; ++j) right[n][j] -= factor * right[m][j];
      }
  }
  for (int m = 0; m < terms; ++m) {
    for (int q = 0; q < Table::count; ++q) table.fit[m][q] = static_cast<T>(right[m][terms + q]);
    for (int a = 0; a < E::nodes; ++a)
      table.at_node[a][m] = static_cast<T>(Polynomial::term(m, E::place(a)));
  }
  return table;
}

}  // namespace pliant::detail
