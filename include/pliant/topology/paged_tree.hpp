#pragma once

#include <cstddef>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/topology/paged_list.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// Marks the pages of entries, for PagedTree::own.
struct PageMarks {
  TreeView tree;
  PageMarker cells, edges, sides;

  PLIANT_HOST_DEVICE void cell(Index c) const { mark<TreeCell>(cells, c); }
  PLIANT_HOST_DEVICE void edge(Index e) const { mark<TreeEdge>(edges, e); }
  PLIANT_HOST_DEVICE void side(Index s) const { mark<TreeSide>(sides, s); }
  /// A cell, its edges and its sides.
  PLIANT_HOST_DEVICE void whole(Index c) const {
    auto const own = tree.row(c);
    auto const& p = tree.cells[static_cast<std::size_t>(c)].pattern();
    cell(c);
    for (std::size_t e = 0; e < static_cast<std::size_t>(p.edges); ++e) edge(own.edges[e]);
    for (std::size_t s = 0; s < static_cast<std::size_t>(p.sides); ++s) side(own.sides[s]);
  }
  /// See TreeView::visit_parts.
  PLIANT_HOST_DEVICE void parts_of(Index c) const {
    tree.visit_parts(
        c, [&](Index own) { cell(own); }, [&](Index own) { edge(own); },
        [&](Index own) { side(own); });
  }
  /// The same by parts: with the cell the first one of its edges and, behind the most that cells have of these, sides.
  PLIANT_HOST_DEVICE void part_of(Index c, Index part) const {
    auto const own = tree.row(c);
    auto const& p = tree.cells[static_cast<std::size_t>(c)].pattern();
    constexpr Index most = RefinementPattern::most_edges;
    if (part == 0) cell(c);
    auto const mark_edge = [&](Index e) { edge(e); };
    if (part < static_cast<Index>(p.edges))
      tree.visit_edge(own.edges[part], mark_edge);
    else if (part >= most && part - most < static_cast<Index>(p.sides))
      tree.visit_side(own.sides[part - most], mark_edge, [&](Index s) { side(s); });
  }

 private:
  template <class V>
  static PLIANT_HOST_DEVICE void mark(PageMarker const& pages, Index i) {
    pages(static_cast<std::size_t>(i) / Page<V>::entries);
  }
};

/// Copies the pages of three lists one behind the other, from a place on.
struct CopyPagesOfTree {
  CopyListedPages<TreeCell> cells;
  CopyListedPages<TreeEdge> edges;
  CopyListedPages<TreeSide> sides;
  std::size_t of_cells, of_edges;  // words
  std::size_t first;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    std::size_t i = first + static_cast<std::size_t>(k);
    if (i < of_cells) return cells(i);
    i -= of_cells;
    if (i < of_edges) return edges(i);
    sides(i - of_edges);
  }
};

/// The cells, edges and sides of a tree in a backend's memory. See PagedList.
template <Backend B>
struct PagedTree {
  PagedList<B, TreeCell> cells;
  PagedList<B, TreeEdge> edges;
  PagedList<B, TreeSide> sides;
  PagedList<B, RowEntry> rows;  // of cells
  RowLayout layout;

  PagedTree(B const& backend, TreeLists const& lists)
      : cells(backend, lists.cells),
        edges(backend, lists.edges),
        sides(backend, lists.sides),
        rows(backend, lists.rows),
        layout(lists.layout),
        listed_(zeros<Index>(backend, 3)),
        told_(backend, 3) {}

  [[nodiscard]] TreeView view() const {
    return {cells.pages(), edges.pages(), sides.pages(), rows.pages(), layout};
  }
  [[nodiscard]] std::size_t bytes() const {
    return cells.bytes() + edges.bytes() + sides.bytes() + rows.bytes();
  }
  void begin_noting(B const& backend) {
    cells.begin_noting(backend);
    edges.begin_noting(backend);
    sides.begin_noting(backend);
    rows.begin_noting(backend);
  }
  void keep() {
    cells.keep();
    edges.keep();
    sides.keep();
    rows.keep();
  }
  void take_back(B const& backend) {
    cells.take_back(backend);
    edges.take_back(backend);
    sides.take_back(backend);
    rows.take_back(backend);
  }
  /// Makes pages the tree's own. mark(marks, tell): runs loops that mark them and, behind these, a step. Waits.
  template <class Mark>
  void own(B const& backend, Mark const& mark) {
    auto* const listed = listed_.data();
    mark(PageMarks{view(), cells.marker(backend, listed), edges.marker(backend, listed + 1),
                   sides.marker(backend, listed + 2)},
         LoopStep{3, TellListed{listed, told_.data()}});
    backend.synchronize();
    auto const counts = told_.template first<3>();
    cells.reserve_own(backend, counts[0]);
    edges.reserve_own(backend, counts[1]);
    sides.reserve_own(backend, counts[2]);
    auto const c = cells.own(backend, counts[0]);
    auto const e = edges.own(backend, counts[1]);
    auto const s = sides.own(backend, counts[2]);
    for_each_piece(c.words + e.words + s.words, [&](std::size_t first, Index n) {
      LoopStep const copy{n, CopyPagesOfTree{c.copy, e.copy, s.copy, c.words, e.words, first}};
      if (first == 0)
        in_turn(backend, c.replace, e.replace, s.replace, copy);
      else
        copy.run(backend);
    });
  }

 private:
  typename B::template Array<Index> listed_;  // how many pages of cells, edges and sides are
  ReadBack<B, Index> told_;
};

}  // namespace pliant::detail
