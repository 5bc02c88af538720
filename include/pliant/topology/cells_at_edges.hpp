#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/math/first_of_each.hpp>
#include <pliant/math/group_by_key.hpp>
#include <pliant/math/unset_vector.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant {

namespace detail {

/// The cells of a tree at each of its edges, as loops see them.
struct CellsAtEdgesView {
  TreeView tree;
  Index initial_edges;
  Index const *first, *cells;  // of the initial mesh: those at edge e are cells[first[e]] on

  /// visit(cell) for those that have an edge as a whole one, leaves and refined ones; those that are split have left theirs
  /// to their children.
  template <class Visit>
  PLIANT_HOST_DEVICE void operator()(Index e, Visit const& visit) const {
    // The edge, the one of which it is a half, and so on: cells that have one have children at the one before.
    Index chain[most_levels + 1];
    int top = 0;
    for (chain[0] = e; chain[top] >= initial_edges && edge(chain[top]).parent() >= 0; ++top)
      chain[top + 1] = edge(chain[top]).parent();
    Index const last = chain[top];
    if (last < initial_edges) {
      for (Index k = first[last]; k < first[last + 1]; ++k) descend(cells[k], chain, top, visit);
      return;
    }
    auto const enter = [&](Index c) {
      if (c < 0 || cell(c).first_child < 0) return;
      Index const count = cell(c).divided().children;
      for (Index k = 0; k < count; ++k) descend(cell(c).first_child + k, chain, top, visit);
    };
    Index const side = edge(last).side();
    if (side < 0) return enter(edge(last).cell());
    enter(tree.sides[static_cast<std::size_t>(side)].cells[0]);
    enter(tree.sides[static_cast<std::size_t>(side)].cells[1]);
  }

 private:
  [[nodiscard]] PLIANT_HOST_DEVICE TreeCell const& cell(Index c) const {
    return tree.cells[static_cast<std::size_t>(c)];
  }
  [[nodiscard]] PLIANT_HOST_DEVICE TreeEdge const& edge(Index e) const {
    return tree.edges[static_cast<std::size_t>(e)];
  }
  [[nodiscard]] PLIANT_HOST_DEVICE bool has(Index c, Index e) const {
    auto const own = tree.row(c);
    int const edges = cell(c).pattern().edges;
    for (int k = 0; k < edges; ++k)
      if (own.edges[k] == e) return true;
    return false;
  }
  /// Visits those among a cell and its descendants, of which it may be one that has chain[top].
  template <class Visit>
  PLIANT_HOST_DEVICE void descend(Index root, Index const* chain, int top,
                                  Visit const& visit) const {
    int depth = top;
    for (Index c = root;;) {
      auto const& own = cell(c);
      bool const is_split = own.is_split();
      bool enters = is_split;
      if (!is_split && has(c, chain[depth])) {
        if (depth == 0)
          visit(c);
        else
          enters = own.first_child >= 0;
      }
      if (enters) {
        if (!is_split) --depth;
        c = own.first_child;
        continue;
      }
      // The next one behind it and its descendants.
      while (c != root) {
        auto const& parent = cell(cell(c).parent);
        if (c + 1 < parent.first_child + parent.divided().children) break;
        c = cell(c).parent;
        if (!parent.is_split()) ++depth;
      }
      if (c == root) return;
      ++c;
    }
  }
};

}  // namespace detail

/// The cells of an initial mesh at each of its edges. Those at an edge that came later are parts of cells that were
/// divided there, so that they are found without a look at all cells.
class CellsAtEdges {
 public:
  /// On the threads of the host.
  explicit CellsAtEdges(TreeLists const& lists) {
    Index const cells = lists.initial.cells;
    auto const first_edge = detail::first_of_each(  // among the edges of all cells
        cells, [&](Index c) { return lists.cells[at(c)].pattern().edges; });
    UnsetVector<Index> edges(at(first_edge.back())), cell_of(edges.size());
    detail::for_each_on_host(cells, few, [&](Index c) {
      auto const own = lists.row(c);
      for (Index i = first_edge[at(c)]; i < first_edge[at(c) + 1]; ++i) {
        edges[at(i)] = own.edges[i - first_edge[at(c)]];
        cell_of[at(i)] = c;
      }
    });
    auto by_edge = detail::group_by_key(edges, lists.initial.edges);
    first_ = std::move(by_edge.first);
    cells_ = std::move(by_edge.order);
    detail::for_each_on_host(static_cast<Index>(cells_.size()), 8 * few,
                             [&](Index k) { cells_[at(k)] = cell_of[at(cells_[at(k)])]; });
  }

  [[nodiscard]] std::span<Index const> first() const { return first_; }
  [[nodiscard]] std::span<Index const> cells() const { return cells_; }
  /// Those of a tree as loops see them.
  [[nodiscard]] detail::CellsAtEdgesView view(TreeLists const& lists) const {
    return {lists.view(), lists.initial.edges, first_.data(), cells_.data()};
  }
  /// The cells of a tree that have an edge as a whole one, leaves and refined ones; those that are split have left theirs
  /// to their children.
  [[nodiscard]] std::vector<Index> of(TreeLists const& lists, Index e) const {
    std::vector<Index> found;
    view(lists)(e, [&](Index c) { found.push_back(c); });
    return found;
  }

 private:
  static constexpr Index few = 2048;  // cells that are worth a thread

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  UnsetVector<Index> first_, cells_;  // by the edge
};

}  // namespace pliant
