#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// Makes divided cells of a tree leaves again, all at once, on the threads of the host. Their children, which are leaves of
/// the same degree, are counted nowhere then, and TreeCompaction takes them away. Refers to the tree's lists.
class CellMerging {
 public:
  explicit CellMerging(TreeLists& lists) : lists_(lists) {}

  /// Divided cells, each once.
  void operator()(std::vector<Index> const& parents) {
    TreeLists::Touched touched(lists_);
    for_each(parents, [&](Index c) {
      auto const& cell = lists_.cells[at(c)];
      touched.add(c);
      for (Index k = 0; k < cell.divided().children; ++k) touched.add(cell.first_child + k);
    });
    lists_.own(touched);
    for (Index const c : parents) {
      auto const& cell = lists_.cells[at(c)];
      lists_.count_leaves(cell.has, 1 - cell.divided().children);
    }
    for_each(parents, [&](Index c) { merge(c); });
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  template <class F>
  static void for_each(std::vector<Index> const& parents, F const& f) {
    for_each_on_host(static_cast<Index>(parents.size()), 256, [&](Index k) { f(parents[at(k)]); });
  }

  void merge(Index c) {
    auto& cell = lists_.cells.edit(at(c));
    auto const& p = cell.divided();
    for (std::size_t i = 0; i < at(p.children); ++i) {
      Index const number = cell.first_child + static_cast<Index>(i);
      auto const& child = lists_.cells[at(number)];
      lists_.count_leaf(child, -1);
      for (std::size_t s = 0; s < at(child.pattern().sides); ++s) {
        auto const [home, k] = p.child_side[i][s];
        bool const is_whole =
            home == RefinementPattern::Home::side && !p.halves && k != p.halved_side;
        replace(child.sides[s], number, is_whole ? c : -1);
      }
    }
    if (p.halves) lists_.count_refined(cell, -1);
    cell.first_child = -1;
    cell.division = Division::refined;
    lists_.count_leaf(cell, 1);
  }
  /// Another thread may replace the cell on the other side.
  void replace(Index side, Index cell, Index other) {
    auto& cells = lists_.sides.edit(at(side)).cells;
    bool const is_first = std::atomic_ref(cells[0]).load(std::memory_order_relaxed) == cell;
    std::atomic_ref(cells[is_first ? 0 : 1]).store(other, std::memory_order_relaxed);
  }

  TreeLists& lists_;
};

}  // namespace pliant::detail
