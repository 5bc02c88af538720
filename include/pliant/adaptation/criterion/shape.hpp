#pragma once

#include <pliant/adaptation/criterion/element_state.hpp>
#include <pliant/adaptation/criterion/unit.hpp>

// How well-shaped an element is at this moment. Note that splitting all edges (red refinement) never
// changes an aspect ratio: give such rules a max_level.
namespace pliant {

/// 1 for the regular cell, growing as it degenerates (Verdict's `aspect_ratio`): triangle
/// l_max Σl/(4√3 A), quadrilateral l_max Σl/(4 A), tetrahedron l_max ΣA_f/(6√6 V); other
/// solids: the longest over the shortest of all edges.
struct AspectRatio {
  static constexpr Unit unit = Unit::one;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    using E = typename State::element;
    using T = builtin_scalar<S>;
    S sum(0), longest(0), shortest = e.edge(0).length();
    for (int k = 0; k < State::edge_count; ++k) {
      S const length = e.edge(k).length();
      sum = sum + length;
      longest = maximum(longest, length);
      shortest = minimum(shortest, length);
    }
    if constexpr (State::dim == 3 && !std::same_as<typename E::cell, Tetrahedron>) {
      return longest / shortest;
    } else {
      auto const x = e.current();
      static constexpr auto table = tabulate<E, Gauss<1>, T>();
      S const size =
          abs(RestMap<E, S>::at(Coefficients<E, S>::of(x), table, 0).volume) * T(table.weight[0]);
      if constexpr (std::same_as<typename E::cell, Triangle>) {
        return longest * sum / (T(6.92820323027550917411) * size);  // 4√3
      } else if constexpr (std::same_as<typename E::cell, Quadrilateral>) {
        return longest * sum / (T(4) * size);
      } else {
        constexpr auto sides = E::cell::sides();
        S area(0);
        for (auto const& side : sides) {
          Vector<S, 3> p, q;
          for (int i = 0; i < 3; ++i) {
            p[i] = x(side[1], i) - x(side[0], i);
            q[i] = x(side[2], i) - x(side[0], i);
          }
          area = area + norm(cross(p, q)) / T(2);
        }
        return longest * area / (T(14.69693845669906858918) * size);  // 6√6
      }
    }
  }
};

/// The harmonic mean of the edges' current lengths, n/Σ(1/l_k), m: dominated by the shortest edge
/// (Caillaud et al. 2013).
struct HarmonicMeanEdge {
  static constexpr Unit unit = Unit::metre;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    S inverses(0);
    for (int k = 0; k < State::edge_count; ++k) inverses = inverses + S(1) / e.edge(k).length();
    return S(State::edge_count) / inverses;
  }
};

/// The harmonic over the arithmetic mean of the edges' lengths: 1 when all are equal, falling to 0.
struct HarmonicMeanShape {
  static constexpr Unit unit = Unit::one;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    S sum(0);
    for (int k = 0; k < State::edge_count; ++k) sum = sum + e.edge(k).length();
    return HarmonicMeanEdge{}(e)*S(State::edge_count) / sum;
  }
};

}  // namespace pliant
