#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include <pliant/topology/hierarchy.hpp>

namespace pliant::test {

/// Of how many sides of cells a tree has other corners than the cells have there, in another order, or edges that do not join
/// them.
template <int Dim>
int count_other_corners(Hierarchy<Dim> const& mesh) {
  auto const view = mesh.tree().lists().view();
  auto const at = [](int i) { return static_cast<std::size_t>(i); };
  int wrong = 0;
  for (Index c = 0; c < static_cast<Index>(mesh.cells().size()); ++c) {
    auto const own = view.row(c);
    auto const& p = mesh.cell(c).pattern();
    for (int s = 0; s < p.sides; ++s) {
      auto const& side = mesh.tree().sides()[at(own.sides[s])];
      auto const nodes = view.corners_of(side);
      int const n = p.corners_of_side(s);
      int found = 0;  // turns and turns back of the cell's own that it is
      for (int start = 0; start < n; ++start)
        for (int step : {1, n - 1}) {
          bool same = static_cast<int>(side.corners()) == n;
          for (int k = 0; same && k < n; ++k)
            same = nodes[at(k)] == own.nodes[p.side[at(s)][at((start + step * k) % n)]];
          found += same;
        }
      wrong += found != 1;
      for (std::size_t k = 0; k < side.corners(); ++k) {
        std::array const ends{nodes[k], nodes[(k + 1) % side.corners()]};
        auto edge = mesh.tree().edges()[at(side.edges[k])].nodes;
        if (side.runs_backwards(k)) std::swap(edge[0], edge[1]);
        wrong += edge != ends;
      }
    }
  }
  return wrong;
}

}  // namespace pliant::test
