#pragma once

#include <pliant/formulation/physics.hpp>
#include <pliant/quadrature/gauss.hpp>

// A criterion is a functor that gives a number for the present state of an element:
//
//   struct MyCriterion {
//     template <class State>
//     PLIANT_HOST_DEVICE auto operator()(State const& e) const { return norm(e.gradient()); }
//   };
//
// The state's numbers may be packs of elements: write `select`, `maximum`, `minimum`, never `if`, on them. State is a
// StateInBody, which adds to the ElementState below what there is around the element.
namespace pliant {

/// What a criterion may look at: the element's law, positions at rest and displacements.
template <class F, class L, class S>
struct ElementState {
  using formulation = F;
  using element = typename F::element;
  using scalar = S;
  static constexpr int dim = F::dim, nodes = F::nodes;

  L const& law;
  Nodal<element, S> const& rest;  // (nodes, dim), m
  Nodal<element, S> const& u;     // (nodes, dim), m

  /// The displacement gradient H = F − I in the middle of the cell.
  PLIANT_HOST_DEVICE Tensor<S, dim> gradient() const {
    static constexpr auto table = tabulate<element, Gauss<1>, builtin_scalar<S>>();
    return RestMap<element, S>::at(Coefficients<element, S>::of(rest), table, 0)
        .gradient(Coefficients<element, S>::of(u), table, 0);
  }
  /// The volume at rest, m³ (per thickness in 2D), by the formulation's rule.
  PLIANT_HOST_DEVICE S volume() const {
    using T = builtin_scalar<S>;
    static constexpr auto table = tabulate<element, typename F::quadrature, T>();
    auto const x = Coefficients<element, S>::of(rest);
    S sum(0);
    for (int q = 0; q < F::points; ++q)
      sum = sum + T(table.weight[q]) * RestMap<element, S>::at(x, table, q).volume;
    return sum;
  }
  /// Where the nodes are now.
  PLIANT_HOST_DEVICE Nodal<element, S> current() const { return rest + u; }

  /// The vector along edge k at rest, its change, and its length now.
  struct Edge {
    Vector<S, dim> at_rest, change;
    S squared_rest, squared_change;  // L² and l² − L², without cancellation
    PLIANT_HOST_DEVICE S length() const { return sqrt(squared_rest + squared_change); }
  };
  PLIANT_HOST_DEVICE Edge edge(int k) const {
    constexpr auto edges = element::edges();
    int const a = edges[static_cast<std::size_t>(k)][0], b = edges[static_cast<std::size_t>(k)][1];
    Edge e;
    for (int i = 0; i < dim; ++i) {
      e.at_rest[i] = rest(b, i) - rest(a, i);
      e.change[i] = u(b, i) - u(a, i);
    }
    e.squared_rest = dot(e.at_rest, e.at_rest);
    S const cross = dot(e.at_rest, e.change);
    e.squared_change = cross + cross + dot(e.change, e.change);
    return e;
  }
  static constexpr int edge_count = static_cast<int>(element::edges().size());
};

template <class F, class L, class S>
PLIANT_HOST_DEVICE ElementState<F, L, S> state_of(L const& law,
                                                  Nodal<typename F::element, S> const& rest,
                                                  Nodal<typename F::element, S> const& u) {
  return {law, rest, u};
}

}  // namespace pliant
