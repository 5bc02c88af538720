#pragma once

#include <cstddef>

#include <pliant/backend/backend.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/topology/changed_elements.hpp>

namespace pliant::detail {

/// Elements of one type that a coarsening merged, and their parents, for loops of a backend: ChangedFamilies of which one comes;
/// families of other types have no elements. Nodes that went have the rows that they had.
template <Element E>
struct MergedElements {
  using gone_element = E;
  using come_element = E;
  static constexpr Index most_gone = 1 << E::dim, most_come = 1;

  LeavesView leaves;  // of the type
  Index count;        // of families
  ElementRows before,
      now;  // the rows of nodes of the type's elements, by their places before and now
  ElementsByRows<E> elements;

  [[nodiscard]] PLIANT_HOST_DEVICE Index gone(Index r) const { return leaves.children(r); }
  [[nodiscard]] PLIANT_HOST_DEVICE Index come(Index r) const {
    return !leaves.has_others || leaves.children(r) > 0 ? 1 : 0;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<E> rows_gone(Index r, Index k) const {
    return taken_rows<E>(before[leaves.first_child_before(r) + k]);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<E> rows_come(Index r, Index) const {
    return taken_rows<E>(now[leaves.merged_place(r)]);
  }
};

}  // namespace pliant::detail
