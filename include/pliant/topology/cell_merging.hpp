#pragma once

#include <cstddef>
#include <vector>

#include <pliant/backend/atomic.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/patterns.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// Whether a child of a refined cell may go, which it may not where a cell at one of its edges is refined.
PLIANT_HOST_DEVICE bool may_go(TreeView const& tree, Index child) {
  auto const own = tree.row(child);
  bool may = true;
  visit_cell(tree.cells[static_cast<std::size_t>(child)].kind, [&]<class Cell>(Cell) {
    for (std::size_t e = 0; e < Cell::edges().size(); ++e)
      may = (tree.edges[static_cast<std::size_t>(own.edges[e])].cells.refined() <= 0) && may;
  });
  return may;
}
/// Whether the children of a divided cell are leaves of one degree, of a split one with corners only, for which
/// is_child_ready(child).
template <class IsChildReady>
PLIANT_HOST_DEVICE bool are_alike(TreeView const& tree, Index c,
                                  IsChildReady const& is_child_ready) {
  auto const& cell = tree.cells[static_cast<std::size_t>(c)];
  if (cell.first_child < 0) return false;
  auto const has = cell.is_split() ? CellNodes::corners
                                   : tree.cells[static_cast<std::size_t>(cell.first_child)].has;
  Index const end = cell.first_child + cell.divided().children;
  for (Index i = cell.first_child; i < end; ++i) {
    auto const& child = tree.cells[static_cast<std::size_t>(i)];
    if (child.first_child >= 0 || child.has != has || !is_child_ready(i)) return false;
  }
  return true;
}
/// Whether they are so, and no neighbour keeps them from being merged.
PLIANT_HOST_DEVICE bool can_be_merged(TreeView const& tree, Index c) {
  bool const is_split = tree.cells[static_cast<std::size_t>(c)].is_split();
  return are_alike(tree, c, [&](Index child) { return is_split || may_go(tree, child); });
}

/// Child i of a divided cell, which is merged, is counted nowhere any more. On the other side of its sides another call may do the same.
/// All is read before anything is written, so that a device waits for memory seldom.
PLIANT_HOST_DEVICE void leave_child_out(TreeView const& tree, Index c, Index i) {
  auto const at = [](Index k) { return static_cast<std::size_t>(k); };
  auto const& cell = tree.cells[at(c)];
  auto const& p = cell.divided();
  Index const number = cell.first_child + i;
  TreeCell const child = tree.cells[at(number)];
  auto const own = tree.row(number);
  visit_cell(child.kind, [&]<class Cell>(Cell) {
    constexpr auto sides = std::size_t{sides_of<Cell>};
    unsigned is_first = 0;  // a bit for each side
    for (std::size_t s = 0; s < sides; ++s)
      is_first |= unsigned{atomic_load(tree.sides[at(own.sides[s])].cells[0]) == number} << s;
    tree.count_child<Cell>(own.edges, p, at(i), child.has, -1);
    for (std::size_t s = 0; s < sides; ++s) {
      auto const& of_parent = p.child_side[at(i)][s];
      bool const is_whole = of_parent.home == RefinementPattern::Home::side && !p.halves &&
                            of_parent.number != p.halved_side;
      atomic_store(tree.sides[at(own.sides[s])].cells[(is_first >> s & 1) != 0 ? 0 : 1],
                   is_whole ? c : -1);
    }
  });
}
/// Makes a divided cell, whose children were left out, a leaf.
PLIANT_HOST_DEVICE void merge_cell(TreeView const& tree, Index c) {
  auto& cell = tree.cells[static_cast<std::size_t>(c)];
  if (cell.divided().halves) tree.count_refined(c, -1);
  cell.first_child = -1;
  cell.division = Division::refined;
  tree.count_leaf(c, 1);
}

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
    auto const tree = lists_.view();
    for_each(parents, [&](Index c) {
      Index const children = lists_.cells[at(c)].divided().children;
      for (Index i = 0; i < children; ++i) leave_child_out(tree, c, i);
      merge_cell(tree, c);
    });
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  template <class F>
  static void for_each(std::vector<Index> const& parents, F const& f) {
    for_each_on_host(static_cast<Index>(parents.size()), 256, [&](Index k) { f(parents[at(k)]); });
  }

  TreeLists& lists_;
};

}  // namespace pliant::detail
