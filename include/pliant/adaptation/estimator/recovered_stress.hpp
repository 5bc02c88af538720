#pragma once

#include <pliant/adaptation/criterion/criterion.hpp>
#include <pliant/adaptation/estimator/material_stress.hpp>
#include <pliant/adaptation/estimator/recovery_table.hpp>

namespace pliant {

/// The error of the mesh, J: ½ ∫ (σ* − σ) : C⁻¹ : (σ* − σ) dV over an element, with its own stress σ and a
/// smoother one, σ* (Zienkiewicz & Zhu 1987). σ is the second Piola-Kirchhoff stress (the stress, under laws
/// of small strain) and C the law's moduli in the middle of the element, so that rotations of the body do not
/// matter. σ* is made of means at nodes by volume, over the elements of one group: stress may jump where
/// another material begins. On quadratic elements the means are of the stress of superconvergent points, carried
/// to the nodes, and of its gradient, whose change over the element gives σ* the quadratic part that such
/// points do not see. The hourglasses of OnePoint are no part of σ. NaN where an element is inverted. The
/// root of the sum is between 0.6 and 1.5 of the true error in most problems; it is least, 0.5, where a few
/// quadratic triangles of a uniform mesh carry the error at a singular corner (tests/verification/RESULTS.md).
struct RecoveredStress {
  static constexpr Unit unit = Unit::joule;

 private:
  template <class F>
  struct Recovery {
    using E = typename F::element;
    static constexpr int dim = F::dim, stresses = detail::SymmetricComponents<F::dim>::count;
    using Polynomial = detail::RecoveredPolynomial<E, F::points>;
    static constexpr bool has_gradient = Polynomial::terms > 1;
    static constexpr int values = stresses * (has_gradient ? 1 + dim : 1);
    /// Points of the rule that see more of the stress than the polynomial; else others see the recovered one.
    static constexpr bool sees_more = F::points > Polynomial::terms;
    using Finer = Gauss<SimplexCell<typename E::cell> ? 2 * E::degree : E::degree + 1>;
    using Rule = std::conditional_t<sees_more, typename F::quadrature, Finer>;
  };
  template <class F, class S>
  using Stress = Vector<S, Recovery<F>::stresses>;
  template <class F, class S>
  struct Coefficients {
    Stress<F, S> of[Recovery<F>::Polynomial::terms];
    template <class Row>
    PLIANT_HOST_DEVICE Stress<F, S> at(Row const& terms) const {
      auto sum = builtin_scalar<S>(terms[0]) * of[0];
      for (int m = 1; m < Recovery<F>::Polynomial::terms; ++m)
        sum = sum + builtin_scalar<S>(terms[m]) * of[m];
      return sum;
    }
  };

 public:
  template <class F>
  static constexpr int nodal_values = Recovery<F>::values;

  /// An element's stress at its nodes, and the gradient of it, (nodes, (1 + dim) stresses).
  template <class State>
  PLIANT_HOST_DEVICE auto to_nodes(State const& e) const {
    using F = typename State::formulation;
    using S = typename State::scalar;
    using R = Recovery<F>;
    using E = typename F::element;
    using T = builtin_scalar<S>;
    static constexpr auto table =
        detail::fit_table<E, typename F::quadrature, T, typename R::Polynomial>();
    auto const stress = fitted(e);
    Matrix<S, F::nodes, R::values> values;
    for (int a = 0; a < F::nodes; ++a) {
      auto const own = stress.at(table.at_node[a]);
      for (int c = 0; c < R::stresses; ++c) values(a, c) = own[c];
    }
    if constexpr (R::has_gradient) {
      static constexpr auto middle = tabulate<E, Gauss<1>, T>();
      auto const map = RestMap<E, S>::at(pliant::Coefficients<E, S>::of(e.rest), middle, 0);
      for (int k = 0; k < F::dim; ++k)
        for (int c = 0; c < R::stresses; ++c) {
          S sum(0);
          for (int j = 0; j < F::dim; ++j)
            sum = sum + stress.of[R::Polynomial::linear_term(j)][c] * map.cofactors(k, j);
          for (int a = 0; a < F::nodes; ++a)
            values(a, R::stresses * (1 + k) + c) = map.inverse_volume * sum;
        }
    }
    return values;
  }

  template <class State, class Means>
  PLIANT_HOST_DEVICE auto operator()(State const& e, Means const& means) const {
    using F = typename State::formulation;
    using S = typename State::scalar;
    using R = Recovery<F>;
    using E = typename F::element;
    using T = builtin_scalar<S>;
    using Rule = typename R::Rule;
    static constexpr auto own =
        detail::fit_table<E, typename F::quadrature, T, typename R::Polynomial>();
    static constexpr auto at = detail::fit_table<E, Rule, T, typename R::Polynomial>();
    static constexpr auto table = tabulate<E, Rule, T>();
    auto const stress = fitted(e);
    auto const compliance = detail::Compliance<S, F::dim>::of(point_law(e.law, 0), e.gradient());
    auto const x = pliant::Coefficients<E, S>::of(e.rest);

    Stress<F, S> jump[F::nodes];  // of the mean over the element's own at nodes
    for (int a = 0; a < F::nodes; ++a) {
      jump[a] = stress.at(own.at_node[a]);
      for (int c = 0; c < R::stresses; ++c) jump[a][c] = means(a, c) - jump[a][c];
    }
    Stress<F, S> off[at.count];  // σ* less the polynomial
    for (int q = 0; q < at.count; ++q) {
      off[q] = T(table.shape[q][0]) * jump[0];
      for (int a = 1; a < F::nodes; ++a) off[q] = off[q] + T(table.shape[q][a]) * jump[a];
    }
    if constexpr (R::has_gradient) add_quadratic_part(e, means, at, table, off);
    if constexpr (R::sees_more)
      for_each_stress<F>(e.law, e.rest, e.u,
                         [&](int q, S const&, Tensor<S, F::dim> const& h,
                             Tensor<S, F::dim> const& p) PLIANT_INLINE {
                           off[q] = off[q] - (detail::material_stress(point_law(e.law, q), h, p) -
                                              stress.at(own.term[q]));
                         });
    S sum(0);
    for (int q = 0; q < at.count; ++q)
      sum = sum + RestMap<E, S>::at(x, table, q).volume * T(table.weight[q]) *
                      compliance.energy_density(off[q]);
    return sum;
  }

 private:
  /// The polynomial nearest to the element's stress.
  template <class State>
  PLIANT_HOST_DEVICE static auto fitted(State const& e) {
    using F = typename State::formulation;
    using S = typename State::scalar;
    using R = Recovery<F>;
    using T = builtin_scalar<S>;
    static constexpr auto table =
        detail::fit_table<typename F::element, typename F::quadrature, T, typename R::Polynomial>();
    Coefficients<F, S> sum;
    for (auto& c : sum.of) c = Stress<F, S>::zero();
    for_each_stress<F>(e.law, e.rest, e.u,
                       [&](int q, S const&, Tensor<S, F::dim> const& h, Tensor<S, F::dim> const& p)
                           PLIANT_INLINE {
                             auto const s = detail::material_stress(point_law(e.law, q), h, p);
                             for (int m = 0; m < R::Polynomial::terms; ++m)
                               sum.of[m] = sum.of[m] + T(table.fit[m][q]) * s;
                           });
    return sum;
  }

  /// Where σ* has the gradient G*, it is a polynomial and ½ (X − X̄)·(G*(X) − G*(X̄)), less the polynomial
  /// nearest to that.
  template <class State, class Means, class At, class Table, class Off>
  PLIANT_HOST_DEVICE static void add_quadratic_part(State const& e, Means const& means,
                                                    At const& at, Table const& table, Off& off) {
    using F = typename State::formulation;
    using S = typename State::scalar;
    using R = Recovery<F>;
    using E = typename F::element;
    using T = builtin_scalar<S>;
    static constexpr auto middle = tabulate<E, Gauss<1>, T>();
    constexpr int corners = E::cell::corners;
    static constexpr auto in_middle =
        detail::fit_table<E, Gauss<1>, T, detail::RecoveredPolynomial<E, 1>>();
    Coefficients<F, S> nearest;
    for (auto& c : nearest.of) c = Stress<F, S>::zero();
    for (int q = 0; q < at.count; ++q) {
      auto part = Stress<F, S>::zero();
      for (int k = 0; k < F::dim; ++k) {
        S away(0);
        for (int a = 0; a < F::nodes; ++a)
          away = away + T(T(table.shape[q][a]) - T(middle.shape[0][a])) * e.rest(a, k);
        for (int c = 0; c < R::stresses; ++c) {
          S more(0);
          for (int a = 0; a < corners; ++a)
            more = more + T(T(at.corner[q][a]) - T(in_middle.corner[0][a])) *
                              means(a, R::stresses * (1 + k) + c);
          part[c] = part[c] + T(0.5) * away * more;
        }
      }
      for (int m = 0; m < R::Polynomial::terms; ++m)
        nearest.of[m] = nearest.of[m] + T(at.fit[m][q]) * part;
      off[q] = off[q] + part;
    }
    for (int q = 0; q < at.count; ++q) off[q] = off[q] - nearest.at(at.term[q]);
  }
};

}  // namespace pliant
