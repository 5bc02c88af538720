#pragma once

#include <pliant/formulation/point_stiffness.hpp>
#include <pliant/formulation/scheme/mean_dilatation.hpp>

namespace pliant {

/// The stiffness of MeanDilatation by tangents of the law at each point, in H and in the mean dilatation θ̄ = Σ_m φ_m θ̄_m,
/// and by how θ̄ follows displacements:
/// K = Σ_q w_q det J ∂H/∂uᵀ ∂²W/∂H² ∂H/∂u + Σ_m (c_m ⊗ ∂θ̄_m/∂u + ∂θ̄_m/∂u ⊗ c_m + Σ_n e_mn ∂θ̄_m/∂u ⊗ ∂θ̄_n/∂u) with
/// c_m = Σ_q w_q det J φ_m ∂H/∂uᵀ ∂²W/∂H∂θ̄ and e_mn = Σ_q w_q det J φ_m φ_n ∂²W/∂θ̄².
template <class F, Geometry G>
struct MeanDilatationStiffness {
  using Scheme = MeanDilatation<F, G>;
  using E = typename F::element;
  static constexpr int dim = F::dim;

  template <class L, class S>
  PLIANT_HOST_DEVICE static Tensor<S, F::nodes * F::dim> of(L const& law, Nodal<E, S> const& rest,
                                                            Nodal<E, S> const& u) {
    using T = builtin_scalar<S>;
    using Onto = Projection<E, S>;
    constexpr int size = F::nodes * dim, modes = Onto::size;
    static constexpr auto table = tabulate<E, typename F::quadrature, T>();
    auto const x = Coefficients<E, S>::of(rest), v = Coefficients<E, S>::of(u);
    auto const mean_of = Scheme::template mean<L>(x, v, table);
    auto pressures = Onto::Polynomial::zero();
    for (int q = 0; q < F::points; ++q) {
      auto const map = RestMap<E, S, G>::at(x, table, q);
      S const dilatation = Onto::value(mean_of.dilatation, table, q);
      auto const pull = pull_of(at_point(law, q), map.gradient(v, table, q), dilatation, S(0));
      Onto::add(pressures, map.volume * T(table.weight[q]) * pull.pressure, table, q);
    }
    pressures = mean_of.onto.nearest(pressures);

    auto k = Tensor<S, size>::zero();
    Vector<S, size> slopes[modes], crossed[modes];  // ∂(∫ φ_m θ)/∂u, and c_m
    for (int m = 0; m < modes; ++m) slopes[m] = crossed[m] = Vector<S, size>::zero();
    auto curvatures = Tensor<S, modes>::zero();  // e_mn
    for (int q = 0; q < F::points; ++q) {
      auto const map = RestMap<E, S, G>::at(x, table, q);
      auto const gradient = detail::rest_gradients<E>(map, table, q);
      auto const h = map.gradient(v, table, q);
      T const weight = T(table.weight[q]);
      S const dilatation = Onto::value(mean_of.dilatation, table, q);
      S const pressure = Onto::value(pressures, table, q);
      auto const change = [&](Tensor<S, dim> const& dh, S const& dmean) {
        return change_of_pull(at_point(law, q), h, dilatation, pressure, dh, dmean);
      };
      detail::add_point_stiffness<E>(
          k, gradient, [&](Tensor<S, dim> const& dh) { return change(dh, S(0)).stress; },
          map.inverse_volume * weight);
      auto const by_mean = change(Tensor<S, dim>::zero(), S(1));
      auto const slope = Point<L, S>(h, dilatation).slope();
      auto const add = [&](Vector<S, size>& to, Tensor<S, dim> const& flux, S const& share) {
        for (int a = 0; a < F::nodes; ++a)
          for (int i = 0; i < dim; ++i) {
            S sum = flux(i, 0) * gradient(0, a);
            for (int l = 1; l < dim; ++l) sum = sum + flux(i, l) * gradient(l, a);
            to[dim * a + i] = to[dim * a + i] + share * sum;
          }
      };
      for (int m = 0; m < modes; ++m) {
        S const share = weight * S(Onto::basis(m, table, q));
        add(slopes[m], slope, share);
        add(crossed[m], by_mean.stress, share);
        for (int n = 0; n < modes; ++n)
          curvatures(m, n) = curvatures(m, n) +
                             map.volume * share * S(Onto::basis(n, table, q)) * by_mean.pressure;
      }
    }
    for (int j = 0; j < size; ++j) {
      auto integrals = Onto::Polynomial::zero();
      for (int m = 0; m < modes; ++m) integrals[m] = slopes[m][j];
      auto const means = mean_of.onto.nearest(integrals);
      for (int m = 0; m < modes; ++m) slopes[m][j] = means[m];  // now ∂θ̄_m/∂u
    }
    for (int m = 0; m < modes; ++m) {
      Vector<S, size> both = crossed[m];
      for (int n = 0; n < modes; ++n)
        for (int j = 0; j < size; ++j) both[j] = both[j] + curvatures(m, n) * slopes[n][j];
      for (int i = 0; i < size; ++i)
        for (int j = i; j < size; ++j)
          k(i, j) = k(i, j) + both[i] * slopes[m][j] + slopes[m][i] * crossed[m][j];
    }
    detail::mirror_upper_half(k);
    return k;
  }

 private:
  template <class L, class S>
  using Point = typename Scheme::template Point<S, Scheme::template linear<L>>;

  /// What a point's energy does when H or the dilatation that it sees changes: ∂W/∂H, where ∂W/∂θ̄ pulls too, and ∂W/∂θ̄
  /// per rest volume.
  template <class S>
  struct Pull {
    Tensor<S, dim> stress;
    S pressure;
  };
  /// pressure: the projected one; without it, what the point does by itself.
  template <class L, class S>
  PLIANT_HOST_DEVICE static Pull<S> pull_of(L const& law, Tensor<S, dim> const& h, S const& mean,
                                            S const& pressure) {
    Point<L, S> const point(h, mean);
    auto const p = pliant::stress(law, point.h_bar);
    S const work = point.work(p);
    S const here = Scheme::template linear<L> ? work : work / (S(1) + point.dilatation);
    return {point.pull(p) + (pressure - here) * point.slope(),
            Scheme::template linear<L> ? work : work / (S(1) + mean)};
  }
  /// Its change along dh and a change of the mean.
  template <class L, class S>
  PLIANT_HOST_DEVICE static Pull<S> change_of_pull(L const& law, Tensor<S, dim> const& h,
                                                   S const& mean, S const& pressure,
                                                   Tensor<S, dim> const& dh, S const& dmean) {
    using D = Dual<S, 1>;
    Tensor<D, dim> variables;
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) {
        variables(i, j).value = h(i, j);
        variables(i, j).derivative[0] = dh(i, j);
      }
    D dilatation(mean);
    dilatation.derivative[0] = dmean;
    auto const pull = pull_of(law, variables, dilatation, D(pressure));
    Pull<S> change;
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) change.stress(i, j) = pull.stress(i, j).derivative[0];
    change.pressure = pull.pressure.derivative[0];
    return change;
  }
};

}  // namespace pliant
