#pragma once

#include <cstddef>

#include <pliant/backend/atomic.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/compaction_view.hpp>
#include <pliant/topology/division_view.hpp>
#include <pliant/topology/hanging_passes.hpp>
#include <pliant/topology/tree_passes.hpp>

// Passes that list the edges and sides of a tree on which nodes hang, for loops of a backend.
namespace pliant::detail {

template <int Dim>
struct IsHungOnEdge {
  HangingView<Dim> view;
  PLIANT_HOST_DEVICE bool operator()(Index e) const { return view.is_hung_on_edge(e); }
};
template <int Dim>
struct IsHungOnSide {
  HangingView<Dim> view;
  PLIANT_HOST_DEVICE bool operator()(Index s) const { return view.is_hung_on_side(s); }
};

/// Of listed edges or sides, lists those on which nodes hang still.
template <class IsHung>
struct ListStillHung {
  IsHung is_hung;
  Index const* known;
  Index* list;
  Index* count;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (is_hung(known[k])) list[atomic_add(*count, 1)] = known[k];
  }
};
/// Lists the edges of refined cells that these bisected, where nodes hang on them.
template <int Dim>
struct ListNewlyHungEdges {
  static constexpr Index each = RefinementPattern::most_edges;
  IsHungOnEdge<Dim> is_hung;
  CellSplit const* cells;
  LeafParts const* parts;
  Index* list;
  Index* count;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    auto const e = static_cast<std::size_t>(k % each);
    if ((parts[k / each].halves >> e & 1) == 0) return;
    Index const edge = is_hung.view.tree.row(cells[k / each].cell).edges[e];
    if (is_hung(edge)) list[atomic_add(*count, 1)] = edge;
  }
};
/// The same of sides that these divided.
template <int Dim>
struct ListNewlyHungSides {
  static constexpr Index each = RefinementPattern::most_sides;
  IsHungOnSide<Dim> is_hung;
  CellSplit const* cells;
  LeafParts const* parts;
  Index* list;
  Index* count;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    auto const s = static_cast<std::size_t>(k % each);
    if ((parts[k / each].parts >> s & 1) == 0) return;
    Index const side = is_hung.view.tree.row(cells[k / each].cell).sides[s];
    if (is_hung(side)) list[atomic_add(*count, 1)] = side;
  }
};

/// Of edges or sides that were listed before a coarsening, lists those on which nodes hang still, by their new numbers.
template <class IsHung>
struct ListStaying {
  IsHung is_hung;
  Index const* known;
  NewNumbers numbers;
  ListOnce list;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (Index const now = numbers(known[k]); now >= 0 && is_hung(now)) list(now);
  }
};
/// Lists the edges of cells that are leaves again, where nodes hang on them.
template <int Dim>
struct ListHungEdgesOfMerged {
  static constexpr Index each = RefinementPattern::most_edges;
  IsHungOnEdge<Dim> is_hung;
  Index const* parents;  // by their old numbers
  NewNumbers numbers;    // of cells
  ListOnce list;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    auto const& tree = is_hung.view.tree;
    Index const c = numbers(parents[k / each]);
    if (k % each >= tree.cells[static_cast<std::size_t>(c)].pattern().edges) return;
    Index const edge = tree.row(c).edges[k % each];
    if (is_hung(edge)) list(edge);
  }
};
/// The same of their sides.
template <int Dim>
struct ListHungSidesOfMerged {
  static constexpr Index each = RefinementPattern::most_sides;
  IsHungOnSide<Dim> is_hung;
  Index const* parents;
  NewNumbers numbers;
  ListOnce list;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    auto const& tree = is_hung.view.tree;
    Index const c = numbers(parents[k / each]);
    if (k % each >= tree.cells[static_cast<std::size_t>(c)].pattern().sides) return;
    Index const side = tree.row(c).sides[k % each];
    if (is_hung(side)) list(side);
  }
};

}  // namespace pliant::detail
