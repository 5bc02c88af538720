#pragma once

#include <cstddef>
#include <cstdint>

#include <pliant/body/merged_family.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/compaction_view.hpp>
#include <pliant/topology/refinement_results.hpp>
#include <pliant/topology/tree_passes.hpp>
#include <pliant/topology/tree_view.hpp>

// Passes over the leaves of a tree in the order that a body keeps, for loops of a backend.
namespace pliant {

namespace detail {

/// Notes where leaves were divided, by their places: into how many.
struct MarkDividedPlaces {
  CellSplit const* leaves;
  LeafParts const* parts;
  Index const* places;
  std::uint8_t* into;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    into[places[leaves[r].cell]] = static_cast<std::uint8_t>(parts[r].cells);
  }
};
/// How many leaves stand in the place of one.
struct LeavesInPlace {
  std::uint8_t const* into;
  PLIANT_HOST_DEVICE Index operator()(Index i) const { return into[i] == 0 ? 1 : Index{into[i]}; }
};
/// Puts leaves, or the children in their place, where they stand now.
struct PutLeaves {
  TreeView tree;
  std::uint8_t const* into;
  Index const* before;  // leaves, by their places
  Index const* start;   // their places now
  Index* leaves;
  Index* places;  // by cell
  Index* from;    // by the place now: that before, of a child its parent's

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const cell = before[i];
    if (into[i] == 0) return put(start[i], cell, i);
    Index const first = tree.cells[static_cast<std::size_t>(cell)].first_child;
    for (Index k = 0; k < Index{into[i]}; ++k) put(start[i] + k, first + k, i);
  }

 private:
  PLIANT_HOST_DEVICE void put(Index place, Index cell, Index old) const {
    leaves[place] = cell;
    places[cell] = place;
    from[place] = old;
  }
};
struct PutPlaces {
  Index const* leaves;
  Index* places;
  PLIANT_HOST_DEVICE void operator()(Index i) const { places[leaves[i]] = i; }
};
/// numbers[k] = of[numbers[k]]
struct LookUp {
  Index const* of;
  Index* numbers;
  PLIANT_HOST_DEVICE void operator()(Index k) const { numbers[k] = of[numbers[k]]; }
};

/// Puts the first place of each block where that has come to, and tells it.
struct MoveBlocks {
  Index const* start;  // by the place before
  Index *first, *told;
  PLIANT_HOST_DEVICE void operator()(Index block) const {
    told[block] = first[block] = start[first[block]];
  }
};

/// New numbers of the cells of a tree that was coarsened.
PLIANT_HOST_DEVICE NewNumbers new_cells(Coarsened const& of) {
  return {of.merged > 0 ? of.staying.cells : of.before.cells, of.cells};
}

/// Notes where children were, and how many a place is kept for: none for those behind the first.
struct FindFamilies {
  TreeView tree;  // as it is now
  Coarsened of;
  Index const* places;  // as they were
  MergedFamily* families;
  std::uint8_t* merged;  // by the place before: 1 for first children, 2 for the others

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    Index const cell = NewNumbers{of.staying.cells, of.cells}(of.parents[r]),
                first = places[of.first_children[r]],
                children = tree.cells[static_cast<std::size_t>(cell)].pattern().children;
    families[r] = {cell, -1, first, children};
    for (Index k = 0; k < children; ++k) merged[first + k] = k == 0 ? 1 : 2;
  }
};
/// How many leaves stand in the place of one.
struct PlacesKept {
  std::uint8_t const* merged;
  PLIANT_HOST_DEVICE Index operator()(Index i) const { return merged[i] == 2 ? 0 : 1; }
};
/// Puts leaves that stay where they stand now; those before get their new numbers, or −1.
struct MoveLeaves {
  NewNumbers numbers;
  std::uint8_t const* merged;
  Index const* start;
  Index* before;
  Index *leaves, *places, *from;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const cell = merged[i] != 0 ? -1 : numbers(before[i]);
    before[i] = cell;
    if (cell < 0) return;
    leaves[start[i]] = cell;
    places[cell] = start[i];
    from[start[i]] = i;
  }
};
/// Puts merged parents there.
struct PutMerged {
  MergedFamily* families;
  Index const* start;
  Index *leaves, *places, *from;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    auto& own = families[r];
    own.place = start[own.first_before];
    leaves[own.place] = own.cell;
    places[own.cell] = own.place;
    from[own.place] = own.first_before;
  }
};

}  // namespace detail

}  // namespace pliant
