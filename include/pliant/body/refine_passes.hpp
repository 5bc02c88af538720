#pragma once

#include <algorithm>
#include <cstddef>

#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/refined_elements.hpp>

// What a refinement does to arrays of a body, for loops of a backend.
namespace pliant::detail {

/// cells[k] = of[cells[k]], from numbers of elements.
struct CellsOfNumbers {
  Index const* of;
  Index* numbers;
  PLIANT_HOST_DEVICE void operator()(Index k) const { numbers[k] = of[numbers[k]]; }
};
struct CellOfSplit {
  CellSplit const* splits;
  Index* cells;
  PLIANT_HOST_DEVICE void operator()(Index r) const { cells[r] = splits[r].cell; }
};
/// Where a new node is at rest.
template <class T, int Dim>
struct PlaceAtRest {
  PlacedNode const* nodes;
  Index const* of_node;
  NodeField<double const, Dim> points;
  Point<Dim> middle;
  NodeField<T, Dim> rest;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const row = of_node[nodes[k].node];
    for (int d = 0; d < Dim; ++d)
      rest(row, d) = static_cast<T>(points(row, d) - middle[static_cast<std::size_t>(d)]);
  }
};
/// The rows of nodes, and groups, of refined elements or of all of their children.
template <Element E, int Width>
struct TakeFamilies {
  RefinedElements<E> elements;
  bool children;
  Tag const* tags_before;  // by the place before; null: all are of group 0
  Index const *places, *from;
  Index* rows;
  Tag* tags;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    constexpr Index per_family = RefinedElements<E>::most_children;
    Index const r = children ? i / per_family : i;
    Index const c = elements.cell(r, children ? i % per_family : -1);
    auto const own = elements.rows_of(c);
    for (std::size_t a = 0; a < own.size(); ++a)
      rows[static_cast<std::ptrdiff_t>(Width) * i + static_cast<std::ptrdiff_t>(a)] = own[a];
    if (tags_before != nullptr) tags[i] = tags_before[from[places[elements.cell(r, 0)]]];
  }
};

/// An array of `count` values of which the first are those of another one.
template <class B, class Array>
Array extended(B const& backend, Array const& from, std::size_t count) {
  using U = ValueOf<Array>;
  auto longer = zeros<U>(backend, count);
  copy_values<B, U>(backend, from.data(), longer.data(), std::min(count, from.size()));
  return longer;
}

}  // namespace pliant::detail
