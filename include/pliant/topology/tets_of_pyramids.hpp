#pragma once

#include <concepts>
#include <cstddef>

#include <pliant/element/linear.hpp>
#include <pliant/topology/refined_elements.hpp>
#include <pliant/topology/rows_of_element.hpp>

// Pyramids that are refined, or merged of their children, for loops of a backend: tetrahedra are among these.
namespace pliant::detail {

/// How many of the children of a refined cell are elements of its own type.
PLIANT_HOST_DEVICE Index children_of_own_type(TreeCell const& parent) {
  return parent.kind == CellKind::pyramid ? pyramids_of_pyramid : Index{parent.pattern().children};
}

/// The tetrahedra of refined pyramids: ChangedFamilies in which they come. Other families have none.
template <Element Tet>
struct ComingTets {
  using gone_element = Tet;
  using come_element = Tet;
  static constexpr Index most_gone = 1, most_come = tets_of_pyramid;

  RefinedElements<Pyramid5> pyramids;
  Index count;
  ElementsByRows<Tet> elements;

  [[nodiscard]] PLIANT_HOST_DEVICE Index gone(Index) const { return 0; }
  [[nodiscard]] PLIANT_HOST_DEVICE Index come(Index r) const {
    return pyramids.gone(r) > 0 ? tets_of_pyramid : 0;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<Tet> rows_gone(Index, Index) const { return {}; }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<Tet> rows_come(Index r, Index k) const {
    return rows_of_element<Tet>(pyramids.tree, pyramids.cell(r, pyramids_of_pyramid + k),
                                pyramids.of_node);
  }
};
/// Those of pyramids that are merged, which go. `Places`: where these were (ConvertedPlaces).
template <Element Tet, class Places>
struct GoingTets {
  using gone_element = Tet;
  using come_element = Tet;
  static constexpr Index most_gone = tets_of_pyramid, most_come = 1;

  Places places;
  Index count;
  ElementRows before;  // the rows of nodes of tetrahedra
  ElementsByRows<Tet> elements;

  [[nodiscard]] PLIANT_HOST_DEVICE Index gone(Index r) const {
    return places.has(r) ? places.families[r].gone : 0;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Index come(Index) const { return 0; }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<Tet> rows_gone(Index r, Index k) const {
    return taken_rows<Tet>(before[places.before_at(r) + k]);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<Tet> rows_come(Index, Index) const { return {}; }
};
/// Families of pyramids, with these.
template <class Pyramids, class Tets>
struct WithTets : Pyramids {
  Tets tets;
};

/// visit(the tetrahedra of families, if they have some).
template <class Families, class Visit>
void visit_tets(Families const& families, Visit const& visit) {
  if constexpr (requires { families.tets; }) visit(families.tets);
}

}  // namespace pliant::detail
