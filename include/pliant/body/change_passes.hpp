#pragma once

#include <algorithm>
#include <cstddef>

#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/refined_elements.hpp>

// What a change of the mesh does to arrays of a body, for loops of a backend.
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
/// Sets listed rows to zero.
template <class T, int Dim>
struct ClearListed {
  Index const* rows;
  NodeField<T, Dim> field;
  PLIANT_HOST_DEVICE void operator()(Index k) const { field.set(rows[k], Vector<T, Dim>::zero()); }
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
