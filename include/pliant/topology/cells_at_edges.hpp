#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <pliant/topology/tree_lists.hpp>

namespace pliant {

/// The cells of an initial mesh at each of its edges. Those at an edge that came later are parts of cells that were
/// divided there, so that they are found without a look at all cells.
class CellsAtEdges {
 public:
  explicit CellsAtEdges(TreeLists const& lists) : first_(at(lists.initial.edges) + 1) {
    auto const for_each_edge = [&](auto const& visit) {
      for (Index c = 0; c < lists.initial.cells; ++c) {
        auto const& cell = lists.cells[at(c)];
        for (std::size_t e = 0; e < at(cell.pattern().edges); ++e) visit(at(cell.edges[e]), c);
      }
    };
    for_each_edge([&](std::size_t e, Index) { ++first_[e + 1]; });
    for (std::size_t e = 1; e < first_.size(); ++e) first_[e] += first_[e - 1];
    cells_.resize(at(first_.back()));
    auto next = first_;
    for_each_edge([&](std::size_t e, Index c) { cells_[at(next[e]++)] = c; });
  }

  /// The cells of a tree that have an edge as a whole one, leaves and refined ones; those that are split have left theirs
  /// to their children.
  [[nodiscard]] std::vector<Index> of(TreeLists const& lists, Index e) const {
    std::vector<Index> found;
    auto const& edge = lists.edges[at(e)];
    if (e < lists.initial.edges) {
      for (auto k = at(first_[at(e)]); k < at(first_[at(e) + 1]); ++k)
        add(lists, cells_[k], e, found);
    } else if (edge.parent >= 0) {
      for (Index const c : of(lists, edge.parent)) add_children(lists, c, e, found);
    } else if (edge.side >= 0) {
      for (Index const c : lists.sides[at(edge.side)].cells)
        if (c >= 0) add_children(lists, c, e, found);
    } else {
      add_children(lists, edge.cell, e, found);
    }
    return found;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  static void add(TreeLists const& lists, Index c, Index e, std::vector<Index>& found) {
    auto const& cell = lists.cells[at(c)];
    if (cell.is_split())
      add_children(lists, c, e, found);
    else if (std::ranges::find(cell.edges, e) != cell.edges.end())
      found.push_back(c);
  }
  static void add_children(TreeLists const& lists, Index c, Index e, std::vector<Index>& found) {
    auto const& cell = lists.cells[at(c)];
    for (Index k = 0; cell.first_child >= 0 && k < cell.divided().children; ++k)
      add(lists, cell.first_child + k, e, found);
  }

  std::vector<Index> first_, cells_;  // by the edge
};

}  // namespace pliant
