#pragma once

#include <cstddef>

#include <pliant/backend/field.hpp>
#include <pliant/formulation/affine.hpp>
#include <pliant/topology/division_view.hpp>
#include <pliant/topology/rows_of_element.hpp>
#include <pliant/topology/tree_on.hpp>

namespace pliant::detail {

/// Cells of a tree that are refined, and their children, as elements of one type, for loops of a backend.
template <Element E>
struct RefinedElements {
  static constexpr Index most_children = 1 << E::dim;

  TreeView tree;
  CellSplit const* cells;
  LeafParts const* parts;
  Index count;           // of these
  Index const* of_node;  // rows, by the user's number
  NodeField<double const, E::dim> points;
  Vector<double, E::nodes> of_cell;  // see nodal_volumes_of_cell

  /// Child k of the refined cell r; the cell itself for k = −1.
  [[nodiscard]] PLIANT_HOST_DEVICE Index cell(Index r, Index k) const {
    Index const parent = cells[r].cell;
    return k < 0 ? parent : tree.cells[static_cast<std::size_t>(parent)].first_child + k;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<E> rows_of(Index c) const {
    return rows_of_element<E>(tree, c, of_node);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Nodal<E, double> rest(RowsOfElement<E> const& rows) const {
    return gather<E::nodes>(points, rows.data());
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Vector<double, E::nodes> masses(RowsOfElement<E> const& rows,
                                                                   double density) const {
    return nodal_masses<E>(rest(rows), density, of_cell);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Vector<double, E::nodes> volumes(
      RowsOfElement<E> const& rows) const {
    return nodal_volumes_by_shape<E, double>(rest(rows), of_cell);
  }
};

/// Those of a refinement. `of_node`, `points`: in the backend's memory, with the nodes that it made.
template <Element E, Backend B>
RefinedElements<E> refined_elements(TreeOn<B> const& tree,
                                    typename TreeOn<B>::Refined const& refined,
                                    Index const* of_node, NodeField<double const, E::dim> points) {
  RefinedElements<E> elements{
      tree.view(), refined.cells, refined.parts, refined.leaves, of_node, points, {}};
  if constexpr (!LinearSimplex<E>) elements.of_cell = nodal_volumes_of_cell<E>();
  return elements;
}

}  // namespace pliant::detail
