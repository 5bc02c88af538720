#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/topology/cell_tree.hpp>
#include <pliant/topology/shape_weights.hpp>
#include <pliant/topology/transfer.hpp>

namespace pliant::detail {

/// Where the nodes of an element lie between the corners of its cell: the corners' weights.
inline std::array<std::array<double, 8>, 27> places_of(TreeCell const& cell) {
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  auto const& p = cell.pattern();
  std::array<std::array<double, 8>, 27> places{};
  std::size_t next = 0;
  for (; next < at(p.corners); ++next) places[next][next] = 1;
  for (std::size_t e = 0; e < at(p.edges); ++e, ++next)
    for (int corner : p.edge[e]) places[next][at(corner)] = 0.5;
  for (std::size_t s = 0; s < at(p.sides); ++s) {
    if (p.side_centre[s] < 0) continue;
    for (int corner : p.side[s]) places[next][at(corner)] = 0.25;
    ++next;
  }
  if (p.centre >= 0)
    for (std::size_t a = 0; a < at(p.corners); ++a) places[next][a] = 1.0 / p.corners;
  return places;
}

/// The nodes of refined cells' children that the cells themselves have not, as they lie between nodes of
/// the cells, and those between the corners of leaves: each once, ascending.
template <int Dim>
std::vector<NewNode> nodes_between(CellTree<Dim> const& tree, std::vector<Index> const& parents,
                                   std::vector<Index> const& lowered) {
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  std::vector<NewNode> found;
  std::vector<bool> seen(at(tree.node_count()), false);
  for (Index const c : lowered) {
    auto const nodes = tree.nodes_of(c);
    auto const places = places_of(tree[c]);
    for (std::size_t a = tree[c].corners(); a < nodes.count; ++a) {
      if (seen[at(nodes[a])]) continue;
      seen[at(nodes[a])] = true;
      NewNode node{nodes[a], {}};
      for (std::size_t b = 0; b < tree[c].corners(); ++b)
        if (places[a][b] != 0) node.parents.emplace_back(nodes[b], places[a][b]);
      found.push_back(std::move(node));
    }
  }
  for (Index const c : parents) {
    auto const& own = tree[c];
    auto const& p = own.divided();
    auto const nodes = tree.nodes_of(c);
    for (Index child = own.first_child; child < own.first_child + p.children; ++child) {
      auto const& corners = p.child[at(child - own.first_child)];
      auto const list = tree.nodes_of(child);
      auto const places = places_of(tree[child]);
      for (std::size_t a = 0; a < list.count; ++a) {
        if (seen[at(list[a])] || std::ranges::find(nodes, list[a]) != nodes.end()) continue;
        seen[at(list[a])] = true;
        std::array<double, 3> place{};
        for (std::size_t b = 0; b < tree[child].corners(); ++b)
          for (std::size_t k = 0; k < 3; ++k) place[k] += places[a][b] * p.place[at(corners[b])][k];
        found.push_back({list[a], shape_weights<Dim>(own.kind, own.has, nodes, place)});
      }
    }
  }
  std::ranges::sort(found, {}, &NewNode::node);
  return found;
}

}  // namespace pliant::detail
