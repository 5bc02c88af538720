#pragma once

#include <concepts>

#include <pliant/backend/field.hpp>
#include <pliant/config.hpp>
#include <pliant/formulation/affine.hpp>
#include <pliant/topology/rows_of_element.hpp>

// Elements of one type that go in a change of a mesh, and those that come in their place, for loops of a backend.
namespace pliant::detail {

/// What elements have by the rows of their nodes.
template <Element E>
struct ElementsByRows {
  NodeField<double const, E::dim> points;  // by row, where nodes are at rest, m
  Vector<double, E::nodes> of_cell{};      // see nodal_volumes_of_cell

  ElementsByRows() = default;
  explicit ElementsByRows(NodeField<double const, E::dim> at_rest) : points(at_rest) {
    if constexpr (!LinearSimplex<E>) of_cell = nodal_volumes_of_cell<E>();
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

/// What the elements of families have that go, or come: `elements`, or of two types `gone_elements` and `come_elements`.
template <bool Come, class Families>
PLIANT_HOST_DEVICE auto const& elements_of(Families const& families) {
  if constexpr (requires { families.elements; })
    return families.elements;
  else if constexpr (Come)
    return families.come_elements;
  else
    return families.gone_elements;
}

/// Families of elements in a change of a mesh: gone(r) elements of family r go, of type gone_element, and come(r) take their place,
/// of type come_element, at most `most_gone` and `most_come`, in the same volume. rows_gone(r, k), rows_come(r, k): the rows of
/// fields that their nodes have; nodes that stay have theirs before and after.
template <class F>
concept ChangedFamilies = requires(F const& families, Index r) {
  { F::most_gone } -> std::convertible_to<Index>;
  { F::most_come } -> std::convertible_to<Index>;
  { families.count } -> std::convertible_to<Index>;
  { families.gone(r) } -> std::same_as<Index>;
  { families.come(r) } -> std::same_as<Index>;
  { families.rows_gone(r, r) } -> std::same_as<RowsOfElement<typename F::gone_element>>;
  { families.rows_come(r, r) } -> std::same_as<RowsOfElement<typename F::come_element>>;
  { elements_of<false>(families) } -> std::convertible_to<ElementsByRows<typename F::gone_element>>;
  { elements_of<true>(families) } -> std::convertible_to<ElementsByRows<typename F::come_element>>;
};

/// The elements of all families that go, or those that come, in one row for loops: places beyond the last one of a family
/// have none.
template <class Families, bool Come>
struct MembersOf {
  using element =
      std::conditional_t<Come, typename Families::come_element, typename Families::gone_element>;
  static constexpr Index most = Come ? Families::most_come : Families::most_gone;
  Families families;

  [[nodiscard]] PLIANT_HOST_DEVICE Index places() const { return most * families.count; }
  [[nodiscard]] PLIANT_HOST_DEVICE bool is_one(Index i) const {
    return i % most < (Come ? families.come(i / most) : families.gone(i / most));
  }
  [[nodiscard]] PLIANT_HOST_DEVICE auto rows(Index i) const {
    if constexpr (Come)
      return families.rows_come(i / most, i % most);
    else
      return families.rows_gone(i / most, i % most);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE auto const& elements() const {
    return elements_of<Come>(families);
  }
};

}  // namespace pliant::detail
