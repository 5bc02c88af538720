#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/element/quadratic_simplex.hpp>
#include <pliant/mesh/bounding_box.hpp>
#include <pliant/topology/topology.hpp>

namespace pliant::detail {

/// The box around a topology's nodes: its middle, how far it reaches from there, m, and its volume, m³ (m² in 2D).
template <int Dim>
struct Extent {
  Point<Dim> middle;
  double reach = 0, volume = 1;
};
template <class M>
Extent<M::dim> extent(Topology<M> const& topology) {
  BoundingBox<M::dim> const bounds(topology.nodes(),
                                   [&](Index node) -> auto& { return topology.point(node); });
  Extent<M::dim> box;
  for (std::size_t k = 0; k < M::dim; ++k) {
    box.middle[k] = (bounds.low[k] + bounds.high[k]) / 2;
    double const size = bounds.high[k] - bounds.low[k];
    box.reach = std::max(box.reach, size / 2);
    box.volume *= size;
  }
  return box;
}

/// How far, along an axis, a node between corners is from the middle of its edge, at most.
template <Element E>
double bend(Nodal<E, double> const& x) {
  constexpr auto edges = E::edges();
  double furthest = 0;
  for (std::size_t e = 0; e < edges.size(); ++e)
    for (int k = 0; k < E::dim; ++k)
      furthest = std::max(furthest, std::abs(x(E::cell::corners + static_cast<int>(e), k) -
                                             (x(edges[e][0], k) + x(edges[e][1], k)) / 2));
  return furthest;
}

/// Whether the nodes between the corners of a topology's elements lie in the middle, as far as T tells.
template <Element E, class T, class M>
bool is_straight(Topology<M> const& topology) {
  if constexpr (CurvedSimplex<E>) {
    auto const count = static_cast<Index>(topology.counts()[type_in<E, M>]);
    HostParts const parts(count, few_elements(E::nodes));
    std::vector<double> of_parts(static_cast<std::size_t>(parts.count()), 0.0);
    parts([&](Index first, Index last, int part) {
      double most = 0;
      for (Index e = first; e < last; ++e)
        most = std::max(most, bend<E>(nodal(topology, topology.template nodes_of<E>(e))));
      of_parts[static_cast<std::size_t>(part)] = most;
    });
    double const furthest = *std::ranges::max_element(of_parts);
    auto const box = extent(topology);
    double distance = 0;  // of the body from the origin: its mesh is rounded there
    for (double x : box.middle) distance = std::max(distance, std::abs(x));
    return furthest <= 8 * (double{std::numeric_limits<T>::epsilon()} * box.reach +
                            std::numeric_limits<double>::epsilon() * distance);
  }
  return false;
}

}  // namespace pliant::detail
