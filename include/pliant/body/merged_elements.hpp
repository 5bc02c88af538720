#pragma once

#include <cstddef>

#include <pliant/backend/backend.hpp>
#include <pliant/body/merged_family.hpp>
#include <pliant/topology/changed_elements.hpp>

namespace pliant::detail {

/// Elements of one type that a coarsening merged, and their parents, for loops of a backend: ChangedFamilies of which one
/// comes. Nodes that went have the rows that they had.
template <Element E>
struct MergedElements {
  static constexpr Index most_gone = 1 << E::dim, most_come = 1;

  MergedFamily const* families;
  Index count;              // of these
  ElementRows before, now;  // the rows of nodes of all elements, by their places before and now
  ElementsByRows<E> elements;

  [[nodiscard]] PLIANT_HOST_DEVICE Index gone(Index r) const { return families[r].children; }
  [[nodiscard]] PLIANT_HOST_DEVICE Index come(Index) const { return 1; }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<E> rows_gone(Index r, Index k) const {
    return taken(before[families[r].first_before + k]);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<E> rows_come(Index r, Index) const {
    return taken(now[families[r].place]);
  }

 private:
  static PLIANT_HOST_DEVICE RowsOfElement<E> taken(Index const* from) {
    RowsOfElement<E> rows{};
    for (std::size_t a = 0; a < rows.size(); ++a) rows[a] = from[a];
    return rows;
  }
};

}  // namespace pliant::detail
