#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include <pliant/backend/atomic.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/cell_row.hpp>
#include <pliant/topology/pages.hpp>
#include <pliant/topology/tree_cell.hpp>

namespace pliant {

/// The lists of a CellTree as loops see them, on the host or on a device.
struct TreeView {
  Pages<TreeCell> cells;
  Pages<TreeEdge> edges;
  Pages<TreeSide> sides;
  Pages<RowEntry> rows;
  RowLayout layout;
  /// Up to so many cells, several threads share each in some loops; more are work enough for a backend.
  static constexpr Index few = 16384;
  bool shared = true;  ///< whether several threads may change an entry at once

  [[nodiscard]] PLIANT_HOST_DEVICE bool is_leaf(Index c) const {
    return cells[at(c)].first_child < 0;
  }

  /// The numbers of a cell's corners, edges and sides.
  [[nodiscard]] PLIANT_HOST_DEVICE CellRow row(Index c) const {
    Index* const nodes = rows[layout.entry(at(c))].numbers.data();
    return {nodes, nodes + layout.first_edge, nodes + layout.first_side};
  }
  /// Puts those of a new `Cell`.
  template <class Cell>
  PLIANT_HOST_DEVICE void put_row(Index c, CellNumbers const& numbers) const {
    if constexpr (Cell::dim == 2)
      put<0>(c, numbers);
    else if (std::same_as<Cell, Tetrahedron> && layout.shift == 1)
      put<1>(c, numbers);
    else
      put<2>(c, numbers);
  }

  /// The nodes of the element on a cell, in the order of an element's whose corners its row has.
  [[nodiscard]] PLIANT_HOST_DEVICE CellNodeList nodes_of(Index c) const {
    auto const& cell = cells[at(c)];
    auto const& p = cell.pattern();
    CellNodeList list;
    auto const own = row(c);
    for (std::size_t a = 0; a < at(p.corners); ++a) list.push_back(own.nodes[a]);
    if (cell.has == CellNodes::corners) return list;
    for (std::size_t e = 0; e < at(p.edges); ++e) list.push_back(edges[at(own.edges[e])].middle);
    if (cell.has != CellNodes::all) return list;
    for (std::size_t s = 0; s < at(p.sides); ++s)
      if (p.side_centre[s] >= 0) list.push_back(sides[at(own.sides[s])].centre);
    if (p.centre >= 0) list.push_back(cell.centre);
    return list;
  }

  /// The same as the element has them, whose volume is positive.
  [[nodiscard]] PLIANT_HOST_DEVICE CellNodeList element_nodes(Index c) const {
    auto list = nodes_of(c);
    if (cells[at(c)].mirrored) list.mirror();
    return list;
  }

  /// The node at corner k of a side.
  [[nodiscard]] PLIANT_HOST_DEVICE Index corner_of(TreeSide const& side, std::size_t k) const {
    return edges[at(side.edges[k])].nodes[side.runs_backwards(k) ? 1 : 0];
  }
  /// Those of all its corners; −1 behind those of a triangle.
  [[nodiscard]] PLIANT_HOST_DEVICE std::array<Index, 4> corners_of(TreeSide const& side) const {
    std::array<Index, 4> nodes{-1, -1, -1, -1};
    for (std::size_t k = 0; k < side.corners(); ++k) nodes[k] = corner_of(side, k);
    return nodes;
  }

  /// The nodes that facets have at a side, of an edge in the plane: those of the leaves beside it, of the highest degree.
  template <int Dim>
  [[nodiscard]] PLIANT_HOST_DEVICE CellNodes nodes_of_facet(Index side) const {
    auto has = CellNodes::corners;
    if constexpr (Dim == 2) {
      visit_edge(side, [&](Index e) {
        if (edges[at(e)].cells.raised() > 0) has = CellNodes::edges;
      });
    } else {
      for (Index const c : sides[at(side)].cells)
        if (c >= 0 && cells[at(c)].has > has) has = cells[at(c)].has;
    }
    return has;
  }

  /// Into how many a side is divided: four, or two triangles between pyramids that are split; none: it is whole.
  [[nodiscard]] PLIANT_HOST_DEVICE Index parts_of(TreeSide const& side) const {
    if (side.first_child < 0) return 0;
    return sides[at(side.first_child)].level == side.level ? 2 : 4;
  }
  /// The cell on the other side of a pyramid's base; −1 where there is none.
  [[nodiscard]] PLIANT_HOST_DEVICE Index across_base(Index pyramid) const {
    auto const& own = sides[at(row(pyramid).sides[0])].cells;
    return own[0] == pyramid ? own[1] : own[0];
  }

  /// An edge, and its halves.
  template <class Visit>
  PLIANT_HOST_DEVICE void visit_edge(Index e, Visit const& visit) const {
    visit(e);
    visit_some(visit, edges[at(e)].first_half, 2);
  }
  /// A side, its parts, and the edges between these.
  template <class Edge, class Side>
  PLIANT_HOST_DEVICE void visit_side(Index s, Edge const& visit_edge,
                                     Side const& visit_side) const {
    auto const& side = sides[at(s)];
    bool const is_halved = parts_of(side) == 2;
    visit_side(s);
    visit_some(visit_side, side.first_child, is_halved ? 2 : 4);
    visit_some(visit_edge, side.first_inner_edge, is_halved ? 1 : side.corners());
  }
  /// What a change of a cell may edit: cell(c), and edge(e) and side(s) for its edges and sides and the parts that these
  /// have, which children of the cell use.
  template <class Cell, class Edge, class Side>
  PLIANT_HOST_DEVICE void visit_parts(Index c, Cell const& visit_cell, Edge const& edge,
                                      Side const& side) const {
    auto const& p = cells[at(c)].pattern();
    auto const own = row(c);
    visit_cell(c);
    for (std::size_t e = 0; e < at(p.edges); ++e) visit_edge(own.edges[e], edge);
    for (std::size_t s = 0; s < at(p.sides); ++s) visit_side(own.sides[s], edge, side);
  }

  /// Counts a leaf at its edges, or with `by` = −1 no more.
  PLIANT_HOST_DEVICE void count_leaf(Index c, int by) const {
    auto const& cell = cells[at(c)];
    detail::visit_cell(cell.kind,
                       [&]<class Cell>(Cell) { count_leaf<Cell>(row(c).edges, cell.has, by); });
  }
  /// The same of a `Cell` with these edges.
  template <class Cell>
  PLIANT_HOST_DEVICE void count_leaf(Index const* of_cell, CellNodes has, int by) const {
    constexpr std::size_t n = Cell::edges().size();
    TreeEdge* own[n];  // all of them first, so that a device waits for memory once
    for (std::size_t e = 0; e < n; ++e) own[e] = &edges[at(of_cell[e])];
    for (std::size_t e = 0; e < n; ++e) add(*own[e], CellsAtEdge::leaf(has), by);
  }
  /// The same of child i of a cell with such a pattern, if it is done for all of them: each edge is written to once.
  template <class Cell>
  PLIANT_HOST_DEVICE void count_child(Index const* of_child, RefinementPattern const& p,
                                      std::size_t i, CellNodes has, int by) const {
    constexpr std::size_t n = Cell::edges().size();
    TreeEdge* own[n];
    for (std::size_t e = 0; e < n; ++e) own[e] = &edges[at(of_child[e])];
    for (std::size_t e = 0; e < n; ++e)
      if (int const children = p.children_at_edge[i][e]; children > 0)
        add(*own[e], CellsAtEdge::leaf(has), by * children);
  }
  /// The same for a refined cell. Split ones count by their children.
  PLIANT_HOST_DEVICE void count_refined(Index c, int by) const {
    auto const own = row(c);
    for (std::size_t e = 0; e < at(cells[at(c)].pattern().edges); ++e)
      add(edges[at(own.edges[e])], CellsAtEdge::refined_cell, by);
  }

  /// Side s of a cell, as the cell sees it.
  [[nodiscard]] PLIANT_HOST_DEVICE TreeSide side_of(CellRow const& cell, std::int16_t level,
                                                    std::size_t s,
                                                    RefinementPattern const& p) const {
    TreeSide side{.level = level};
    unsigned backwards = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (p.side[s][k] < 0) break;
      side.edges[k] = cell.edges[at(p.edges_of_side[s][k])];
      bool const begins_here = edges[at(side.edges[k])].nodes[0] == cell.nodes[at(p.side[s][k])];
      backwards |= static_cast<unsigned>(!begins_here) << k;
    }
    side.backwards = static_cast<std::uint16_t>(backwards);
    return side;
  }

 private:
  /// visit(number) for `count` numbers from `first` on; for none where that is negative.
  template <class Visit>
  static PLIANT_HOST_DEVICE void visit_some(Visit const& visit, Index first, std::size_t count) {
    for (std::size_t k = 0; first >= 0 && k < count; ++k) visit(first + static_cast<Index>(k));
  }
  /// Counts a cell by `one` so often at an edge.
  PLIANT_HOST_DEVICE void add(TreeEdge& edge, std::uint64_t one, int by) const {
    std::uint64_t const sum = one * static_cast<std::uint64_t>(by);
    if (shared)
      detail::atomic_add(edge.cells.all, sum);
    else
      edge.cells.all += sum;
  }
  template <int Shift>
  PLIANT_HOST_DEVICE void put(Index c, CellNumbers const& numbers) const {
    constexpr auto own = Shift == 0   ? RowLayout::of_plane_cells()
                         : Shift == 1 ? RowLayout::of_tetrahedra()
                                      : RowLayout::of_solid_cells();
    for (std::size_t k = 0; k < std::size_t{1} << Shift; ++k) {
      RowEntry entry;
      for (std::size_t i = 0; i < RowEntry::count; ++i)
        entry.numbers[i] = own.number(numbers, static_cast<Index>(RowEntry::count * k + i));
      rows[(at(c) << Shift) + k] = entry;
    }
  }
  static PLIANT_HOST_DEVICE std::size_t at(Index i) { return static_cast<std::size_t>(i); }
};

}  // namespace pliant
