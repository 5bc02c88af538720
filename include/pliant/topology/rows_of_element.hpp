#pragma once

#include <array>
#include <cstddef>

#include <pliant/topology/shape_weights.hpp>
#include <pliant/topology/tree_view.hpp>

namespace pliant::detail {

/// Tells the cells of a tree whose leaves are elements of one type; all are, unless there are others.
struct CellsOfType {
  CellKind kind = CellKind::triangle;
  CellNodes has = CellNodes::corners;
  bool has_others = false;
  PLIANT_HOST_DEVICE bool operator()(TreeCell const& cell) const {
    return !has_others || (cell.kind == kind && cell.has == has);
  }
  /// Whether a node was made on a cell that was one of them then.
  PLIANT_HOST_DEVICE bool made(TreeView const& tree, PlacedNode const& node) const {
    return !has_others ||
           (node.had == has && tree.cells[static_cast<std::size_t>(node.cell)].kind == kind);
  }
};
template <Element E>
PLIANT_HOST_DEVICE constexpr CellsOfType cells_of_type(bool has_others) {
  return {kind_of<typename E::cell>, nodes_on_cell<E>, has_others};
}

/// The rows of fields that the nodes of an element have, in the element's order.
template <Element E>
using RowsOfElement = std::array<Index, static_cast<std::size_t>(E::nodes)>;

/// A copy of such rows.
template <Element E>
PLIANT_HOST_DEVICE RowsOfElement<E> taken_rows(Index const* from) {
  RowsOfElement<E> rows{};
  for (std::size_t a = 0; a < rows.size(); ++a) rows[a] = from[a];
  return rows;
}
/// Those of the element that a cell of a tree is. `of_node`: rows, by the user's numbers of nodes.
template <Element E>
PLIANT_HOST_DEVICE RowsOfElement<E> rows_of_element(TreeView const& tree, Index c,
                                                    Index const* of_node) {
  RowsOfElement<E> rows;
  if constexpr (nodes_on_cell<E> == CellNodes::corners) {
    bool const mirrored = tree.cells[static_cast<std::size_t>(c)].mirrored;
    auto const* const nodes = tree.row(c).nodes;
    for (std::size_t a = 0; a < rows.size(); ++a)
      rows[a] = of_node[nodes[mirrored && (a == 2 || a == 3) ? 5 - a : a]];
  } else {
    auto const nodes = tree.element_nodes(c);
    for (std::size_t a = 0; a < rows.size(); ++a) rows[a] = of_node[nodes[a]];
  }
  return rows;
}

}  // namespace pliant::detail
