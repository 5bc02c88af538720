#pragma once

#include <pliant/topology/hierarchy.hpp>

namespace pliant::test {

/// How many edges and sides of leaves touch leaves that are two levels finer.
template <int Dim>
int count_level_jumps(Hierarchy<Dim> const& mesh) {
  auto const& edges = mesh.tree().edges();
  auto const& sides = mesh.tree().sides();
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  auto const is_bisected = [&](Index e) { return edges[at(e)].first_half >= 0; };
  int jumps = 0;
  for (Index const c : mesh.leaves()) {
    auto const own = mesh.tree().row(c);
    auto const& p = mesh.cell(c).pattern();
    for (int e = 0; e < p.edges; ++e)
      if (Index const half = edges[at(own.edges[e])].first_half; half >= 0)
        jumps += is_bisected(half) || is_bisected(half + 1);
    for (int s = 0; s < p.sides; ++s) {
      auto const& side = sides[at(own.sides[s])];
      if (side.first_child < 0) continue;
      for (Index k = 0; k < 4; ++k) jumps += sides[at(side.first_child + k)].first_child >= 0;
      for (Index k = 0; k < static_cast<Index>(side.corners()); ++k)
        jumps += is_bisected(side.first_inner_edge + k);
    }
  }
  return jumps;
}

}  // namespace pliant::test
