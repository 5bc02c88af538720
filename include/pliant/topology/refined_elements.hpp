#pragma once

#include <concepts>
#include <cstddef>

#include <pliant/backend/field.hpp>
#include <pliant/element/linear.hpp>
#include <pliant/topology/changed_elements.hpp>
#include <pliant/topology/division_view.hpp>
#include <pliant/topology/rows_of_element.hpp>
#include <pliant/topology/tree_on.hpp>

namespace pliant::detail {

/// The children of a refined pyramid: so many pyramids, then tetrahedra.
inline constexpr Index pyramids_of_pyramid = 6, tets_of_pyramid = 4;

/// Cells of a tree that are refined, and their children, as elements of one type, for loops of a backend: ChangedFamilies of
/// which one goes; cells of other types have no elements. Of the children of pyramids these are those that are pyramids.
template <Element E>
struct RefinedElements {
  using gone_element = E;
  using come_element = E;
  static constexpr Index most_children = 1 << E::dim;
  static constexpr Index most_gone = 1, most_come = most_children;

  TreeView tree;
  CellSplit const* cells;
  LeafParts const* parts;
  Index count;           // of these
  bool has_others;       // whether cells may be of another type
  Index const* of_node;  // rows, by the user's number
  ElementsByRows<E> elements;

  /// Child k of the refined cell r; the cell itself for k = −1.
  [[nodiscard]] PLIANT_HOST_DEVICE Index cell(Index r, Index k) const {
    Index const parent = cells[r].cell;
    return k < 0 ? parent : tree.cells[static_cast<std::size_t>(parent)].first_child + k;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<E> rows_of(Index c) const {
    return rows_of_element<E>(tree, c, of_node);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Index gone(Index r) const { return is_one(r) ? 1 : 0; }
  [[nodiscard]] PLIANT_HOST_DEVICE Index come(Index r) const {
    return !is_one(r) ? 0 : std::same_as<E, Pyramid5> ? pyramids_of_pyramid : Index{parts[r].cells};
  }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<E> rows_gone(Index r, Index) const {
    return rows_of(cell(r, -1));
  }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<E> rows_come(Index r, Index k) const {
    return rows_of(cell(r, k));
  }

 private:
  [[nodiscard]] PLIANT_HOST_DEVICE bool is_one(Index r) const {
    return cells_of_type<E>(has_others)(tree.cells[static_cast<std::size_t>(cells[r].cell)]);
  }
};

/// Those of a refinement. `of_node`, `points`: in the backend's memory, with the nodes that it made. `has_others`: whether the tree
/// has cells of several types.
template <Element E, Backend B>
RefinedElements<E> refined_elements(TreeOn<B> const& tree,
                                    typename TreeOn<B>::Refined const& refined,
                                    Index const* of_node, NodeField<double const, E::dim> points,
                                    bool has_others = false) {
  return {tree.view(),
          refined.cells,
          refined.parts,
          refined.leaves,
          has_others,
          of_node,
          ElementsByRows<E>(points)};
}

}  // namespace pliant::detail
