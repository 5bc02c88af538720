#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <pliant/backend/backend.hpp>
#include <pliant/topology/paged_list.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// Marks the pages of entries, a byte each, for PagedTree::own.
struct PageMarks {
  TreeView tree;
  std::uint8_t *cells, *edges, *sides;

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
  static PLIANT_HOST_DEVICE void mark(std::uint8_t* pages, Index i) {
    atomic_set(pages[static_cast<std::size_t>(i) / Page<V>::entries], 1);
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
        layout(lists.layout) {}

  [[nodiscard]] TreeView view() const {
    return {cells.pages(), edges.pages(), sides.pages(), rows.pages(), layout};
  }
  [[nodiscard]] std::size_t bytes() const {
    return cells.bytes() + edges.bytes() + sides.bytes() + rows.bytes();
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
  /// Makes pages the tree's own: mark(marks) runs loops that mark them.
  template <class Mark>
  void own(B const& backend, Mark const& mark) {
    auto const c = cells.page_count(), e = edges.page_count(), s = sides.page_count();
    auto touched = zeros<std::uint8_t>(backend, c + e + s);
    auto* const first = touched.data();
    mark(PageMarks{view(), first, first + c, first + c + e});
    auto const bytes = download<std::uint8_t>(touched);
    std::span const all(bytes);
    cells.change(backend, all.subspan(0, c));
    edges.change(backend, all.subspan(c, e));
    sides.change(backend, all.subspan(c + e, s));
  }
};

}  // namespace pliant::detail
