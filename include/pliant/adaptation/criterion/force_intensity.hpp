#pragma once

#include <pliant/adaptation/criterion/element_state.hpp>
#include <pliant/adaptation/criterion/unit.hpp>

namespace pliant {

enum class PointWeights {
  volume,  ///< w_i det J_i: an average over the element
  rule     ///< w_i alone, as the paper prints it
};

/// R_S = (1/A(t)) Σ_i w_i det J_i Σ_j ‖Λ_j(g_i) F_E(P_j)‖: how strongly an element pulls at its
/// nodes, N (Caillaud et al. 2013). The paper prints it without det J; that form grows like stress
/// over size, so that refinement feeds itself and burrows into one corner.
template <PointWeights Weights = PointWeights::volume>
struct ForceIntensity {
  static constexpr Unit unit = Unit::newton;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using F = typename State::formulation;
    using E = typename State::element;
    using S = typename State::scalar;
    using T = builtin_scalar<S>;
    auto const f = force<F>(e.law, e.rest, e.u);
    Vector<S, F::nodes> pull;
    for (int a = 0; a < F::nodes; ++a) {
      S squared = f(a, 0) * f(a, 0);
      for (int i = 1; i < F::dim; ++i) squared = squared + f(a, i) * f(a, i);
      pull[a] = sqrt(squared);
    }
    auto const x = Coefficients<E, S>::of(e.current());
    static constexpr auto table = tabulate<E, typename F::quadrature, T>();
    S sum(0), size(0);
    for (int q = 0; q < F::points; ++q) {
      S intensity(0);
      for (int a = 0; a < F::nodes; ++a) intensity = intensity + T(table.shape[q][a]) * pull[a];
      S const volume = T(table.weight[q]) * RestMap<E, S>::at(x, table, q).volume;
      size = size + volume;
      sum = sum + intensity * (Weights == PointWeights::volume ? volume : S(T(table.weight[q])));
    }
    return sum / size;
  }
};

}  // namespace pliant
