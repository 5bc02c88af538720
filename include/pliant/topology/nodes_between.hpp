#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/cell_tree.hpp>
#include <pliant/topology/shape_weights.hpp>
#include <pliant/topology/transfer.hpp>
#include <pliant/topology/tree_claims.hpp>

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
/// the cells, and those between the corners of leaves: each once, ascending, without those of the initial mesh. Where several
/// cells have one, the first of the list tells.
template <int Dim>
WeightedNodes nodes_between(CellTree<Dim> const& tree, std::vector<Index> const& lowered,
                            std::vector<Index> const& parents) {
  constexpr Index few = 512;  // cells that are worth a thread
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  Index const initial = tree.initial_nodes();
  auto const cells = static_cast<Index>(lowered.size() + parents.size());
  auto const cell_at = [&](Index k) {
    return at(k) < lowered.size() ? lowered[at(k)] : parents[at(k) - lowered.size()];
  };
  // visit(node, weights) for the nodes between those of a cell; weights() gives those of the nodes that it lies between.
  auto const visit_nodes = [&](Index k, auto const& visit) {
    Index const c = cell_at(k);
    auto const& own = tree[c];
    auto const nodes = tree.nodes_of(c);
    if (at(k) < lowered.size()) {
      auto const places = places_of(own);
      for (std::size_t a = own.corners(); a < nodes.count; ++a)
        visit(nodes[a], [&] {
          ShapeWeights weights;
          for (std::size_t b = 0; b < own.corners(); ++b)
            if (places[a][b] != 0) weights.push_back({nodes[b], places[a][b]});
          return weights;
        });
      return;
    }
    auto const& p = own.divided();
    for (Index child = own.first_child; child < own.first_child + p.children; ++child) {
      auto const list = tree.nodes_of(child);
      for (std::size_t a = 0; a < list.count; ++a) {
        if (std::ranges::find(nodes, list[a]) != nodes.end()) continue;
        visit(list[a], [&] {
          auto const& corners = p.child[at(child - own.first_child)];
          auto const places = places_of(tree[child]);
          std::array<double, 3> place{};
          for (std::size_t b = 0; b < tree[child].corners(); ++b)
            for (std::size_t d = 0; d < 3; ++d)
              place[d] += places[a][b] * p.place[at(corners[b])][d];
          return shape_weights<Dim>(own.kind, own.has, nodes, place);
        });
      }
    }
  };
  std::vector<Index> first(at(tree.node_count() - initial), -1);  // claims of places in the list
  bool const shared = HostThreads::now() > 1;
  for_each_on_host(cells, few, [&](Index k) {
    visit_nodes(k, [&](Index node, auto const&) {
      if (node >= initial) claim(first[at(node - initial)], k, shared);
    });
  });
  Index count = 0;
  std::vector<Index> places(first.size());
  for (std::size_t node = 0; node < first.size(); ++node) {
    places[node] = count;
    count += first[node] < -1 ? 1 : 0;
  }
  struct Found {
    int part = -1;  // its list
    std::size_t place = 0;
  };
  std::vector<Found> found(at(count));
  HostParts const parts(cells, few);
  std::vector<WeightedNodes> lists(at(parts.count()));
  parts([&](Index from, Index to, int part) {
    WeightedNodes list;
    for (Index k = from; k < to; ++k)
      visit_nodes(k, [&](Index node, auto const& weights) {
        if (node < initial || !makes(k, first[at(node - initial)])) return;
        auto& own = found[at(places[at(node - initial)])];
        if (own.part >= 0) return;
        own = {part, list.size()};
        list.push_back(node, weights());
      });
    lists[at(part)] = std::move(list);
  });
  auto const node_at = [&](Found const& own) { return lists[at(own.part)][own.place]; };
  std::vector<std::size_t> sizes(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) sizes[i] = node_at(found[i]).parents.size();
  WeightedNodes ascending(sizes);
  for_each_on_host(count, 4096, [&](Index i) { ascending.set(at(i), node_at(found[at(i)])); });
  return ascending;
}

}  // namespace pliant::detail
