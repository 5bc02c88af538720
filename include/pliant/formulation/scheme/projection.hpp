#pragma once

#include <pliant/formulation/points.hpp>

namespace pliant {

/// Fields on an element as the polynomials nearest to them: constant, but linear in ξ where the shape
/// functions of a tensor-product element are quadratic. A constant dilatation would leave maps free
/// there that are conformal inside the element, x ↦ 2 (b·x) x − |x|² b, and beams would bend too easily.
template <Element E, class S>
class Projection {
 public:
  static constexpr int size = E::degree == 2 && !CurvedSimplex<E> ? E::dim + 1 : 1;
  using Polynomial = Vector<S, size>;  // coefficients of φ = 1, ξ_1, ... ξ_d

  /// φ_m at point q.
  template <class Table>
  PLIANT_HOST_DEVICE static auto basis(int m, Table const& table, int q) {
    return table.monomial[q][m == 0 ? 0 : power(Table::exponents, m - 1)];
  }
  template <class Table>
  PLIANT_HOST_DEVICE static S value(Polynomial const& p, Table const& table, int q) {
    S sum = p[0];
    for (int m = 1; m < size; ++m) sum = sum + p[m] * basis(m, table, q);
    return sum;
  }
  /// Adds what point q has of the integrals of a field with each φ_m.
  template <class Table>
  PLIANT_HOST_DEVICE static void add(Polynomial& integrals, S const& x, Table const& table, int q) {
    for (int m = 0; m < size; ++m) integrals[m] = integrals[m] + x * basis(m, table, q);
  }
  template <class Table>
  PLIANT_HOST_DEVICE void add_weight(S const& weight, Table const& table, int q) {
    for (int m = 0; m < size; ++m)
      for (int n = 0; n <= m; ++n)
        moments_(m, n) = moments_(m, n) + weight * (basis(m, table, q) * basis(n, table, q));
  }
  /// Once all weights are in: moments = L D Lᵀ, with L below the diagonal.
  PLIANT_HOST_DEVICE void factorise() {
    for (int k = 0; k < size; ++k)
      for (int m = k + 1; m < size; ++m) {
        S const factor = moments_(m, k) / moments_(k, k);
        for (int n = k + 1; n <= m; ++n) moments_(m, n) = moments_(m, n) - factor * moments_(n, k);
      }
    for (int k = 0; k < size; ++k)
      for (int m = k + 1; m < size; ++m) moments_(m, k) = moments_(m, k) / moments_(k, k);
  }
  /// The polynomial that has these integrals.
  PLIANT_HOST_DEVICE Polynomial nearest(Polynomial p) const {
    for (int k = 0; k < size; ++k)
      for (int m = k + 1; m < size; ++m) p[m] = p[m] - moments_(m, k) * p[k];
    for (int k = size - 1; k >= 0; --k) {
      p[k] = p[k] / moments_(k, k);
      for (int m = k + 1; m < size; ++m) p[k] = p[k] - moments_(m, k) * p[m];
    }
    return p;
  }

 private:
  Tensor<S, size> moments_ = Tensor<S, size>::zero();  // ∫ φ_m φ_n, the lower half
};

}  // namespace pliant
