#pragma once

#include <cstddef>
#include <cstdint>

#include <pliant/backend/atomic.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/cell_merging.hpp>
#include <pliant/topology/compaction_view.hpp>
#include <pliant/topology/paged_tree.hpp>
#include <pliant/topology/tree_passes.hpp>

// Passes over cells of a tree that is coarsened, for loops of a backend.
namespace pliant::detail {

/// Stamps marked leaves that may go, and lists the cells of which they are children: refined ones, or split ones. Negative marks are
/// none.
struct ListFamilies {
  TreeView tree;
  Index const* marked;
  bool of_split;
  ListOnce list;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (marked[k] < 0) return;
    auto const& cell = tree.cells[static_cast<std::size_t>(marked[k])];
    if (cell.first_child >= 0 || cell.parent < 0) return;
    if (tree.cells[static_cast<std::size_t>(cell.parent)].is_split() != of_split) return;
    if (!of_split && !may_go(tree, marked[k])) return;
    atomic_store(list.stamps[marked[k]], list.now);
    list(cell.parent);
  }
};
/// Lists those of them of which all children are stamped and alike, with their numbers for keys; of two split pyramids that share a
/// base both or none. A call for each that there may be.
struct ListMergeable {
  TreeView tree;
  Index const* families;
  Index const* listed;  // how many of these there are
  Index const* stamps;  // by cell
  Index now;
  Index* list;
  Index* count;
  std::uint64_t* keys;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (k >= *listed) return;
    Index const c = families[k];
    if (!are_stamped(c)) return;
    auto const& cell = tree.cells[static_cast<std::size_t>(c)];
    if (cell.is_split() && cell.kind == CellKind::pyramid && !are_stamped(tree.across_base(c)))
      return;
    Index const place = atomic_add(*count, 1);
    list[place] = c;
    keys[place] = static_cast<std::uint64_t>(c);
  }

 private:
  [[nodiscard]] PLIANT_HOST_DEVICE bool are_stamped(Index c) const {
    return are_alike(tree, c, [&](Index child) { return stamps[child] == now; });
  }
};
/// Marks the pages of what becomes leaves, and of their children. So many calls for each of the former.
struct MarkMerged {
  static constexpr Index each = 1 + RefinementPattern::most_children;
  Index const* parents;
  PageMarks marks;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const c = parents[k / each], i = k % each;
    auto const& cell = marks.tree.cells[static_cast<std::size_t>(c)];
    if (i == 0)
      marks.whole(c);
    else if (i <= cell.divided().children)
      marks.whole(cell.first_child + i - 1);
  }
};
/// The children of divided cells that are merged are counted nowhere any more. So many calls for each of these.
struct LeaveChildrenOut {
  static constexpr Index each = RefinementPattern::most_children;
  TreeView tree;
  Index const* parents;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const c = parents[k / each], i = k % each;
    if (i < tree.cells[static_cast<std::size_t>(c)].divided().children) leave_child_out(tree, c, i);
  }
};
/// Makes divided cells leaves of the degree of their children. Notes the first of these, and how many they were.
struct MergeCells {
  TreeView tree;
  Index const* parents;
  Index *first_children, *children;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    auto& cell = tree.cells[static_cast<std::size_t>(parents[k])];
    first_children[k] = cell.first_child;
    children[k] = cell.divided().children;
    cell.has = tree.cells[static_cast<std::size_t>(cell.first_child)].has;
    merge_cell(tree, parents[k]);
  }
};

}  // namespace pliant::detail
