#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include <pliant/backend/atomic.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/cells_at_edges.hpp>
#include <pliant/topology/division_view.hpp>
#include <pliant/topology/element_nodes.hpp>
#include <pliant/topology/paged_tree.hpp>
#include <pliant/topology/stamps.hpp>

// Passes over cells of a tree, for loops of a backend.
namespace pliant::detail {

/// Lists marked leaves below a level; negative ones are none.
struct ListMarked {
  TreeView tree;
  Index const* marked;
  int max_level;
  ListOnce list;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (marked[k] < 0) return;
    auto const& cell = tree.cells[static_cast<std::size_t>(marked[k])];
    if (cell.first_child < 0 && cell.level < max_level) list(marked[k]);
  }
};

/// Lists the leaves that are coarser across one of the edges or sides of a cell of the list. Each part of a side has an
/// edge that lies between parts, so that edges tell of coarser neighbours across sides too. A call for each edge of a cell.
struct ListCoarser {
  CellsAtEdgesView at_edges;
  Index each;           // edges that a cell has at most
  Index from;           // of the list: those before were looked at
  Index const* listed;  // how many there are when the loop begins
  ListOnce list;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (from + k / each >= *listed) return;
    TreeView const& tree = at_edges.tree;
    auto const at = [](Index i) { return static_cast<std::size_t>(i); };
    auto const want = [&](Index c) {
      if (c >= 0 && tree.is_leaf(c)) list(c);
    };
    Index const c = list.list[from + k / each], e = k % each;
    if (e >= tree.cells[at(c)].pattern().edges) return;
    Index coarse = tree.row(c).edges[at(e)], whole = coarse;
    do {
      whole = coarse;
      coarse = tree.edges[at(coarse)].parent();
    } while (coarse >= 0 && tree.edges[at(coarse)].cells.leaves() == 0);
    if (coarse >= 0) {
      at_edges(coarse, want);
    } else if (Index const side = tree.edges[at(whole)].side(); side >= 0) {
      // a leaf on the other side of a divided side may have none of it for an edge
      want(tree.sides[at(side)].cells[0]);
      want(tree.sides[at(side)].cells[1]);
    }
  }
};

/// Lists the leaves that share an edge, whole or in part, with listed ones. A call for each edge of a cell.
struct ListNeighbours {
  CellsAtEdgesView at_edges;
  Index each;  // edges that a cell has at most
  Index const* cells;
  ListOnce list;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    TreeView const& tree = at_edges.tree;
    auto const at = [](Index i) { return static_cast<std::size_t>(i); };
    Index const c = cells[k / each], e = k % each;
    if (e >= tree.cells[at(c)].pattern().edges) return;
    auto const list_at = [&](Index edge) {
      at_edges(edge, [&](Index other) {
        if (tree.is_leaf(other)) list(other);
      });
    };
    Index const own = tree.row(c).edges[at(e)], whole = tree.edges[at(own)].parent(),
                half = tree.edges[at(own)].first_half;
    list_at(own);
    if (whole >= 0 && tree.edges[at(whole)].cells.leaves() > 0) list_at(whole);
    for (Index part = half; half >= 0 && part < half + 2; ++part) list_at(part);
  }
};

/// Keys by which listed cells are sorted: coarser ones first, then ascending.
struct LevelKeys {
  TreeView tree;
  Index const* list;
  std::uint64_t* keys;
  int bits_of_cell;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    auto const level = tree.cells[static_cast<std::size_t>(list[k])].level;
    keys[k] =
        static_cast<std::uint64_t>(level) << bits_of_cell | static_cast<std::uint32_t>(list[k]);
  }
};
struct ListLeaves {
  Index const* list;
  CellSplit* leaves;
  PLIANT_HOST_DEVICE void operator()(Index k) const { leaves[k] = {list[k], Division::refined}; }
};

/// Marks the pages that a division of leaves edits. A call for each leaf, or for each edge and side of one.
struct MarkDivided {
  static constexpr Index parts = RefinementPattern::most_edges + RefinementPattern::most_sides;
  CellSplit const* leaves;
  PageMarks marks;
  Index each;  // calls: 1, or `parts`
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const c = leaves[k / each].cell;
    if (each == 1)
      marks.parts_of(c);
    else
      marks.part_of(c, k % each);
  }
};

/// How much of one sort each leaf makes.
template <Index LeafParts::*Count>
struct CountOf {
  LeafParts const* parts;
  PLIANT_HOST_DEVICE Index operator()(Index r) const { return parts[r].*Count; }
};
/// Numbers for what each leaf makes, by how many of each sort come before.
struct NumberParts {
  LeafParts* parts;
  std::array<Index const*, 4> before;  // nodes, edges, sides, cells; their totals behind them
  TreeSizes first;
  Index leaves;
  Index* totals;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    if (r == leaves) {
      for (std::size_t k = 0; k < 4; ++k) totals[k] = before[k][leaves];
      return;
    }
    parts[r].node = first.nodes + before[0][r];
    parts[r].edge = first.edges + before[1][r];
    parts[r].side = first.sides + before[2][r];
    parts[r].cell = first.cells + before[3][r];
  }
};

/// The functions of a DivisionView, for each leaf.
struct ClaimShared {
  DivisionView division;
  PLIANT_HOST_DEVICE void operator()(Index r) const { division.claim_shared(r); }
};
struct FindParts {
  DivisionView division;
  PLIANT_HOST_DEVICE void operator()(Index r) const { division.find_parts(r); }
};
struct MakeInside {
  DivisionView division;
  PLIANT_HOST_DEVICE void operator()(Index r) const { division.make_inside(r); }
};
/// The same for each edge, side and child of leaves, of which there are so many at most.
struct MakeOnEdges {
  static constexpr Index each = RefinementPattern::most_edges;
  DivisionView division;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    division.make_on_edge(k / each, static_cast<std::size_t>(k % each));
  }
};
struct MakeOnSides {
  static constexpr Index each = RefinementPattern::most_sides;
  DivisionView division;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    division.make_on_side(k / each, static_cast<std::size_t>(k % each));
  }
};
struct MakeChildren {
  static constexpr Index each = RefinementPattern::most_children;
  DivisionView division;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (k % each < division.parts[k / each].cells)
      division.make_child(k / each, static_cast<std::size_t>(k % each));
  }
};

/// How many children of a leaf have nodes between their corners, and a list of them.
struct CountQuadratic {
  DivisionView division;
  PLIANT_HOST_DEVICE Index operator()(Index r) const {
    return division.cell(r).has == CellNodes::corners ? 0 : division.parts[r].cells;
  }
};
struct ListQuadratic {
  CountQuadratic count;
  Index const* before;
  Index* list;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    for (Index k = 0; k < count(r); ++k) list[before[r] + k] = count.division.parts[r].cell + k;
  }
};
/// The functions of an ElementNodesView, for each cell.
struct ClaimNodes {
  ElementNodesView nodes;
  PLIANT_HOST_DEVICE void operator()(Index k) const { nodes.claim_nodes(k); }
};
struct FindNodes {
  ElementNodesView nodes;
  PLIANT_HOST_DEVICE void operator()(Index k) const { nodes.find_nodes(k); }
};
struct CountNodes {
  CellNodesMade const* own;
  PLIANT_HOST_DEVICE Index operator()(Index k) const { return std::popcount(own[k].bits); }
};
struct MakeNodes {
  ElementNodesView nodes;
  Index const* before;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    nodes.own[k].first = nodes.first_node + before[k];
    nodes.make_nodes(k);
  }
};

}  // namespace pliant::detail
