#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <pliant/backend/array_copies.hpp>
#include <pliant/backend/atomic.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/compaction_view.hpp>
#include <pliant/topology/refined_elements.hpp>

// What a change of the mesh does to arrays of a body, for loops of a backend.
namespace pliant::detail {

struct CellOfSplit {
  CellSplit const* splits;
  Index* cells;
  PLIANT_HOST_DEVICE void operator()(Index r) const { cells[r] = splits[r].cell; }
};
struct RenumberCells {
  NewNumbers numbers;
  Index* cells;
  PLIANT_HOST_DEVICE void operator()(Index k) const { cells[k] = numbers(cells[k]); }
};
/// The place of a merged cell among the parents, which ascend; negative: it is none. `number_of`(parent): by what it is told.
template <class NumberOf>
PLIANT_HOST_DEVICE Index place_among(Index const* parents, Index count, Index cell,
                                     NumberOf const& number_of) {
  Index low = 0, high = count;
  while (low < high) {
    Index const middle = low + (high - low) / 2;
    if (number_of(parents[middle]) < cell)
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && number_of(parents[low]) == cell ? low : -1;
}
/// Notes which of the merged cells are refined again.
struct FindMergedAgain {
  CellSplit const* refined;
  Index const* parents;  // old numbers
  NewNumbers numbers;
  Index count;
  Index* again;  // (count), and behind them whether there are any
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    Index const k = place_among(parents, count, refined[r].cell, numbers);
    if (k < 0) return;
    atomic_store(again[k], 1);
    atomic_store(again[count], 1);
  }
};
/// Whether a marked cell is of no family that would be divided again.
struct IsMergedForGood {
  TreeView tree;
  Index const* cells;
  Index const* parents;
  Index count;
  Index const* again;
  PLIANT_HOST_DEVICE bool operator()(Index k) const {
    Index const parent = tree.cells[static_cast<std::size_t>(cells[k])].parent;
    auto const same = [](Index own) { return own; };
    Index const place = parent < 0 ? -1 : place_among(parents, count, parent, same);
    return place < 0 || again[place] == 0;
  }
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
/// Notes which of listed rows have other displacements than before a change.
template <class T, int Dim>
struct MarkDisplaced {
  Index const* rows;
  NodeField<T const, Dim> before, now;
  std::uint8_t* displaced;  // by the row
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const row = rows[k];
    bool stays = true;
    for (int d = 0; d < Dim; ++d) stays = stays && before(row, d) == now(row, d);
    displaced[row] = stays ? 0 : 1;
  }
};
/// Sets listed rows to zero.
template <class T, int Dim>
struct ClearListed {
  Index const* rows;
  NodeField<T, Dim> field;
  PLIANT_HOST_DEVICE void operator()(Index k) const { field.set(rows[k], Vector<T, Dim>::zero()); }
};

/// An array of `count` values of which the first are those of another one, and the others zero.
template <class B, class Array>
Array extended(B const& backend, Array const& from, std::size_t count) {
  ArrayCopies<B> copies(backend);
  auto longer = copies.template extended<ValueOf<Array>>(from, count);
  copies.make();
  return longer;
}

}  // namespace pliant::detail
