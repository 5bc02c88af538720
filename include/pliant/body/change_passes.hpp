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
/// The same of cells that are split; of those along a diagonal ~cell.
struct SplitOfCell {
  CellSplit const* splits;
  Index* cells;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    auto const [cell, division] = splits[r];
    bool const in_two = division == Division::diagonal_0 || division == Division::diagonal_1;
    cells[r] = in_two ? ~cell : cell;
  }
};
struct RenumberCells {
  NewNumbers numbers;
  Index* cells;
  PLIANT_HOST_DEVICE void operator()(Index k) const { cells[k] = numbers(cells[k]); }
};
/// The place of a cell among some, which ascend; negative: it is none.
PLIANT_HOST_DEVICE Index place_among(Index const* cells, Index count, Index cell) {
  Index low = 0, high = count;
  while (low < high) {
    Index const middle = low + (high - low) / 2;
    if (cells[middle] < cell)
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && cells[low] == cell ? low : -1;
}
/// Cells in ascending order, and which of them a refinement divides.
struct DividedCells {
  Index const* cells;
  Index count;
  Index* divided;  // (count), and behind them whether any is

  /// Whether a cell is one of them and is divided.
  [[nodiscard]] PLIANT_HOST_DEVICE bool operator()(Index cell) const {
    Index const place = place_among(cells, count, cell);
    return place >= 0 && divided[place] != 0;
  }
};
/// Notes which are divided; `now`: the numbers that they have then, which ascend too.
struct FindDivided {
  CellSplit const* refined;
  Index const* now;
  DividedCells of;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    Index const k = place_among(now, of.count, refined[r].cell);
    if (k < 0) return;
    atomic_store(of.divided[k], 1);
    atomic_store(of.divided[of.count], 1);
  }
};
/// Whether a marked cell is of no family that would be divided again.
struct IsMergedForGood {
  TreeView tree;
  Index const* cells;
  DividedCells families;
  PLIANT_HOST_DEVICE bool operator()(Index k) const {
    Index const parent = tree.cells[static_cast<std::size_t>(cells[k])].parent;
    return parent < 0 || !families(parent);
  }
};
/// The same of cells that were split: their parents are known, −1 for none, and of pyramids those across the base.
struct IsWholeForGood {
  Index const *parents, *partners;
  DividedCells families;
  PLIANT_HOST_DEVICE bool operator()(Index k) const {
    return !families(parents[k]) && !families(partners[k]);
  }
};
/// Finds these.
struct FindWholes {
  TreeView tree;
  Index const* cells;
  Index *parents, *partners;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    parents[k] = cells[k] < 0 ? -1 : tree.cells[static_cast<std::size_t>(cells[k])].parent;
    partners[k] = -1;
    if (parents[k] < 0) return;
    auto const& parent = tree.cells[static_cast<std::size_t>(parents[k])];
    if (parent.is_split() && parent.kind == CellKind::pyramid)
      partners[k] = tree.across_base(parents[k]);
  }
};
/// Whether a cell would not be divided.
struct IsLoweredForGood {
  Index const* cells;
  DividedCells lowered;
  PLIANT_HOST_DEVICE bool operator()(Index k) const { return !lowered(cells[k]); }
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
/// Notes which of listed rows have other displacements than before a change, of those that there were.
template <class T, int Dim>
struct MarkDisplaced {
  Index const* rows;
  Index count_before;  // rows
  NodeField<T const, Dim> before, now;
  std::uint8_t* displaced;  // by the row
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const row = rows[k];
    bool stays = true;
    for (int d = 0; d < Dim && row < count_before; ++d)
      stays = stays && before(row, d) == now(row, d);
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

/// Cells of which a trial tells which are divided.
template <Backend B>
class Divided {
 public:
  /// Of those in a list, ascending, which may go with the next change; `numbers`: that they have by now.
  Divided(B const& backend, Index const* cells, Index count, NewNumbers const& numbers)
      : cells_(unset<Index>(backend, static_cast<std::size_t>(count))),
        divided_(zeros<Index>(backend, static_cast<std::size_t>(count) + 1)) {
    if (count == 0) return;
    copy_values<B, Index>(backend, cells, cells_.data(), cells_.size());
    now_ = extended(backend, cells_, cells_.size());
    backend.for_each(count, RenumberCells{numbers, now_.data()});
  }
  /// Gives them the numbers that they have behind another change, which leaves them.
  void renumber(B const& backend, NewNumbers const& numbers) {
    backend.for_each(static_cast<Index>(now_.size()), RenumberCells{numbers, now_.data()});
  }
  /// Waits.
  template <class Refined>
  void find(B const& backend, Refined const& refined) {
    if (cells_.size() == 0) return;
    backend.for_each(refined.leaves, FindDivided{refined.cells, now_.data(), listed()});
    auto any = zeros<Index>(backend, 1);
    copy_values<B, Index>(backend, divided_.data() + cells_.size(), any.data(), 1);
    any_ = download<Index>(any)[0] != 0;
  }
  [[nodiscard]] bool any() const { return any_; }
  [[nodiscard]] DividedCells listed() {
    return {cells_.data(), static_cast<Index>(cells_.size()), divided_.data()};
  }

 private:
  typename B::template Array<Index> cells_, now_, divided_;
  bool any_ = false;
};

}  // namespace pliant::detail
