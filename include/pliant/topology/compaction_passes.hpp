#pragma once

#include <cstddef>

#include <pliant/backend/atomic.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/compaction_view.hpp>
#include <pliant/topology/paged_tree.hpp>
#include <pliant/topology/tree_passes.hpp>

// Passes that take away what nothing uses any more of a tree that was coarsened, for loops of a backend. See TreeCompaction.
namespace pliant::detail {

/// Lists cells before others that know of these (see DivisionMarks): those of which the k-th of the others is the first child.
struct ListDividedSince {
  TreeView tree;
  Index first;  // of the others
  ListOnce list;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const c = first + k, p = tree.cells[static_cast<std::size_t>(c)].parent;
    if (p >= 0 && p < first && tree.cells[static_cast<std::size_t>(p)].first_child == c) list(p);
  }
};
/// Those that became leaves, or lost nodes.
struct ListMerged {
  Index const* parents;
  Index end;
  ListOnce list;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (parents[k] < end) list(parents[k]);
  }
};
/// And cells of the initial mesh that have not the nodes that they had there.
struct ListConverted {
  TreeView tree;
  ListOnce list;
  PLIANT_HOST_DEVICE void operator()(Index c) const {
    auto const& cell = tree.cells[static_cast<std::size_t>(c)];
    if (cell.has != cell.had) list(c);
  }
};

/// Cells that know of newer entries: listed ones, and all from one on. Of their edges and sides, those that are not newer themselves.
struct KnowingCells {
  Index const* listed;
  Index count;      // of these
  TreeSizes first;  // of the others, and of newer entries

  [[nodiscard]] PLIANT_HOST_DEVICE Index cell(Index k) const {
    return k < count ? listed[k] : first.cells + k - count;
  }
};
/// Marks the pages of such cells, and of their edges and sides.
struct MarkKnowing {
  KnowingCells knowing;
  Index const* count;  // of those that are listed; null: as many as are known
  PageMarks marks;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (count != nullptr && k >= *count) return;
    Index const c = knowing.cell(k);
    auto const own = marks.tree.row(c);
    auto const& p = marks.tree.cells[static_cast<std::size_t>(c)].pattern();
    if (c < knowing.first.cells) marks.cell(c);
    for (std::size_t e = 0; e < static_cast<std::size_t>(p.edges); ++e)
      if (own.edges[e] < knowing.first.edges) marks.edge(own.edges[e]);
    for (std::size_t s = 0; s < static_cast<std::size_t>(p.sides); ++s)
      if (own.sides[s] < knowing.first.sides) marks.side(own.sides[s]);
  }
};

/// The first children that go, for a maximum: the largest is that of the first.
struct NegatedFirstChild {
  Index const* first_children;  // by parent
  PLIANT_HOST_DEVICE double operator()(Index k) const { return -first_children[k]; }
};

/// Stamps the nodes behind those that stay that cells use which stay: of those behind these, and of listed ones.
struct UseNodes {
  CompactionView view;
  Index* stamps;  // by nodes behind those that stay
  Index now;
  Index const* listed = nullptr;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const c = listed != nullptr ? listed[k] : view.staying.cells + k;
    if (!view.stays(c)) return;
    auto* const own = stamps;
    Index const stamp = now;
    view.use_nodes_of(c, [&](Index node) { atomic_set(own[node], stamp); });
  }
};

/// Whether an entry behind those that stay does too, to be summed.
struct CountStamped {
  Index const* stamps;
  Index now;
  PLIANT_HOST_DEVICE Index operator()(Index k) const { return stamps[k] == now ? 1 : 0; }
};
struct CountCells {
  CompactionView view;
  PLIANT_HOST_DEVICE Index operator()(Index k) const {
    return view.stays(view.staying.cells + k) ? 1 : 0;
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

/// Moves entries behind those that stay to where they are then.
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
/// Tells each side at cells that know of newer entries once the numbers of what moved, if it is not newer itself. So many calls for
/// each of these cells share its sides.
struct TellSides {
  static constexpr Index most = RefinementPattern::most_sides;
  CompactionView view;
  TreeView tree;  // as it is then
  KnowingCells knowing;
  Index each;     // calls
  Index* stamps;  // by side before those that may move
  Index now;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const c = knowing.cell(k / each);
    auto const own = tree.row(c);
    Index const sides = tree.cells[static_cast<std::size_t>(c)].pattern().sides;
    for (Index s = k % each; s < sides; s += each)
      if (Index const side = own.sides[s];
          side < knowing.first.sides && stamps_first(stamps[side], now))
        view.renumber_within(tree.sides[static_cast<std::size_t>(side)]);
  }
};
/// The same of edges.
struct TellEdges {
  static constexpr Index most = RefinementPattern::most_edges;
  CompactionView view;
  TreeView tree;
  KnowingCells knowing;
  Index each;
  Index* stamps;  // by edge
  Index now;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const c = knowing.cell(k / each);
    auto const own = tree.row(c);
    Index const edges = tree.cells[static_cast<std::size_t>(c)].pattern().edges;
    for (Index e = k % each; e < edges; e += each)
      if (Index const edge = own.edges[e];
          edge < knowing.first.edges && stamps_first(stamps[edge], now))
        view.renumber_within(tree.edges[static_cast<std::size_t>(edge)]);
  }
};
/// And of listed cells.
struct TellCells {
  CompactionView view;
  TreeView tree;
  Index const* cells;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    view.renumber_within(tree.cells[static_cast<std::size_t>(cells[k])]);
  }
};

}  // namespace pliant::detail
