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

/// Stamps marked leaves that may go, and lists the refined cells of which they are children.
struct ListFamilies {
  TreeView tree;
  Index const* marked;
  ListOnce list;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    auto const& cell = tree.cells[static_cast<std::size_t>(marked[k])];
    if (cell.first_child >= 0 || cell.parent < 0) return;
    if (tree.cells[static_cast<std::size_t>(cell.parent)].is_split()) return;
    if (!may_go(tree, marked[k])) return;
    atomic_store(list.stamps[marked[k]], list.now);
    list(cell.parent);
  }
};
/// Lists those of them of which all children are stamped and alike, with their numbers for keys. A call for each that there may
/// be.
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
    if (!are_alike(tree, c, [&](Index child) { return stamps[child] == now; })) return;
    Index const place = atomic_add(*count, 1);
    list[place] = c;
    keys[place] = static_cast<std::uint64_t>(c);
  }
};
/// Whether a cell of the initial mesh knows of cells, edges, sides or nodes that came later.
struct IsKnowing {
  TreeView tree;
  PLIANT_HOST_DEVICE bool operator()(Index c) const {
    auto const& cell = tree.cells[static_cast<std::size_t>(c)];
    return cell.first_child >= 0 || cell.has != cell.had;
  }
};
/// Lists refined cells of the initial mesh that knew of none before.
struct ListRefined {
  TreeView tree;  // after it
  Index initial;  // cells
  CellSplit const* refined;
  Index* list;
  Index* count;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    Index const c = refined[r].cell;
    if (c >= initial) return;
    auto const& cell = tree.cells[static_cast<std::size_t>(c)];
    if (cell.has == cell.had) list[atomic_add(*count, 1)] = c;
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
/// Marks the pages of cells of the initial mesh, their edges and sides.
struct MarkKnowing {
  Index const* cells;
  PageMarks marks;

  PLIANT_HOST_DEVICE void operator()(Index k) const { marks.whole(cells[k]); }
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
/// Makes divided cells leaves of the degree of their children. Notes the first of these.
struct MergeCells {
  TreeView tree;
  Index const* parents;
  Index* first_children;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    auto& cell = tree.cells[static_cast<std::size_t>(parents[k])];
    first_children[k] = cell.first_child;
    cell.has = tree.cells[static_cast<std::size_t>(cell.first_child)].has;
    merge_cell(tree, parents[k]);
  }
};

/// Stamps the nodes behind the initial mesh's that cells use which stay: of those behind the initial mesh's, and of listed
/// ones.
struct UseNodes {
  CompactionView view;
  Index* stamps;  // by nodes behind the initial mesh's
  Index now;
  Index const* listed = nullptr;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const c = listed != nullptr ? listed[k] : view.initial.cells + k;
    if (!view.stays(c)) return;
    auto* const own = stamps;
    Index const stamp = now;
    view.use_nodes_of(c, [&](Index node) { atomic_set(own[node], stamp); });
  }
};

/// Whether an entry behind the initial mesh's stays, to be summed.
struct CountStamped {
  Index const* stamps;
  Index now;
  PLIANT_HOST_DEVICE Index operator()(Index k) const { return stamps[k] == now ? 1 : 0; }
};
struct CountCells {
  CompactionView view;
  PLIANT_HOST_DEVICE Index operator()(Index k) const {
    return view.stays(view.initial.cells + k) ? 1 : 0;
  }
};
template <class V>
struct CountUsed {
  Pages<V> entries;
  Index first;
  PLIANT_HOST_DEVICE Index operator()(Index k) const {
    return CompactionView::is_used(entries[static_cast<std::size_t>(first + k)]) ? 1 : 0;
  }
};
/// New numbers of `count` entries from `first` on, by how many stay before each; those that go have −1. A call more notes how
/// many stay.
struct NumberStaying {
  Index const* before;
  Index count, first;
  Index* numbers;
  Index* staying;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (k == count)
      *staying = before[k];
    else
      numbers[k] = before[k] < before[k + 1] ? first + before[k] : -1;
  }
};

/// Moves entries behind the initial mesh's to where they are then.
template <class V>
struct MoveUp {
  CompactionView view;
  NewNumbers numbers;
  Pages<V> before, now;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const to = numbers.others[k];
    if (to < 0) return;
    V own = before[static_cast<std::size_t>(numbers.first + k)];
    view.renumber(own);
    now[static_cast<std::size_t>(to)] = own;
  }
};
/// The same of the entries of cells' rows, a call each.
struct MoveRowsUp {
  CompactionView view;
  Pages<RowEntry> before, now;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const k = i >> view.tree.layout.shift, to = view.cells.others[k];
    if (to < 0) return;
    Index const entry = i - (k << view.tree.layout.shift);
    auto const at = [&](Index c) {
      return view.tree.layout.entry(static_cast<std::size_t>(c)) + static_cast<std::size_t>(entry);
    };
    RowEntry own = before[at(view.cells.first + k)];
    view.renumber(own, entry);
    now[at(to)] = own;
  }
};
/// Tells listed cells of the initial mesh, and each of their edges and sides once, the numbers of what moved. So many calls for
/// each of these cells share its sides or edges.
struct TellSides {
  static constexpr Index most = RefinementPattern::most_sides;
  CompactionView view;
  TreeView tree;  // as it is then
  Index const* cells;
  Index each;     // calls
  Index* stamps;  // by side of the initial mesh
  Index now;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const c = cells[k / each];
    auto const own = tree.row(c);
    Index const sides = tree.cells[static_cast<std::size_t>(c)].pattern().sides;
    for (Index s = k % each; s < sides; s += each)
      if (stamps_first(stamps[own.sides[s]], now))
        view.renumber_within(tree.sides[static_cast<std::size_t>(own.sides[s])]);
  }
};
struct TellEdges {
  static constexpr Index most = RefinementPattern::most_edges;
  CompactionView view;
  TreeView tree;
  Index const* cells;
  Index each;
  Index* stamps;  // by edge of the initial mesh
  Index now;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const c = cells[k / each];
    auto const own = tree.row(c);
    Index const edges = tree.cells[static_cast<std::size_t>(c)].pattern().edges;
    for (Index e = k % each; e < edges; e += each)
      if (stamps_first(stamps[own.edges[e]], now))
        view.renumber_within(tree.edges[static_cast<std::size_t>(own.edges[e])]);
  }
};
/// Lists those that know of others still.
struct TellCells {
  CompactionView view;
  TreeView tree;
  Index const* cells;
  Index* knowing;
  Index* count;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    view.renumber_within(tree.cells[static_cast<std::size_t>(cells[k])]);
    if (IsKnowing{tree}(cells[k])) knowing[atomic_add(*count, 1)] = cells[k];
  }
};

}  // namespace pliant::detail
