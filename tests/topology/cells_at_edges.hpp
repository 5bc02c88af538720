#pragma once

#include <algorithm>
#include <vector>

#include <pliant/topology/hierarchy.hpp>

namespace pliant::test {

/// Of how many edges a tree finds other cells than a look at all of them does.
template <int Dim>
int count_edges_with_other_cells(Hierarchy<Dim> const& mesh) {
  auto const& tree = mesh.tree();
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  std::vector<std::vector<Index>> all(tree.edges().size());
  for (Index c = 0; c < static_cast<Index>(tree.cells().size()); ++c)
    if (!tree[c].is_split())
      for (int e = 0; e < tree[c].pattern().edges; ++e) all[at(tree.row(c).edges[e])].push_back(c);
  auto const by = tree.cells_at_edges();
  int wrong = 0;
  for (std::size_t e = 0; e < all.size(); ++e) {
    auto found = tree.cells_at(*by, static_cast<Index>(e));
    std::ranges::sort(found);
    wrong += found != all[e];
  }
  return wrong;
}

}  // namespace pliant::test
