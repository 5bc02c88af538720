#pragma once

#include <cstddef>
#include <cstdint>

#include <pliant/body/node_row_passes.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/tree_view.hpp>

// Passes over the leaves of a tree in the order that a body keeps, some of which go over to another element type, for loops of a
// backend.
namespace pliant::detail {

/// The order of the leaves of a tree: cells of the initial mesh have theirs, and children stand in the place of their parents.
struct TreeOrder {
  TreeView tree;
  Index const* places;  // of the initial mesh's cells

  /// Whether one of two leaves comes before the other.
  [[nodiscard]] PLIANT_HOST_DEVICE bool precedes(Index one, Index other) const {
    for (int apart = depth(one) - depth(other); apart != 0; apart += apart > 0 ? -1 : 1)
      (apart > 0 ? one : other) = parent(apart > 0 ? one : other);
    while (parent(one) != parent(other)) {
      one = parent(one);
      other = parent(other);
    }
    return parent(one) < 0 ? places[one] < places[other] : one < other;
  }

 private:
  [[nodiscard]] PLIANT_HOST_DEVICE Index parent(Index c) const {
    return tree.cells[static_cast<std::size_t>(c)].parent;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE int depth(Index c) const {
    int count = 0;
    while ((c = parent(c)) >= 0) ++count;
    return count;
  }
};

/// The blocks of leaves, those of all types one behind the other.
struct LeafBlocks {
  Index const* first;  // place, (count + 1)
  Index count;
  /// That of a place.
  [[nodiscard]] PLIANT_HOST_DEVICE Index of(Index place) const {
    return lower_place(first, count + 1, place + 1) - 1;
  }
};
/// Notes the places that leaves go away from, and keys by which leaves that arrive are sorted: their blocks and, in these, the places
/// from which they come.
struct LeavePlaces {
  static constexpr int bits_of_place = 32;
  LeafBlocks blocks;
  Index const* other_block;  // by block: that of the same cells of the other type
  Index const* cells;
  Index const* places;  // by cell
  std::uint8_t* goes;
  std::uint64_t* keys;
  Index* arriving;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    Index const place = places[cells[r]];
    goes[place] = 1;
    keys[r] = static_cast<std::uint64_t>(other_block[blocks.of(place)]) << bits_of_place |
              static_cast<std::uint32_t>(place);
    arriving[r] = cells[r];
  }
};
struct StaysThere {
  std::uint8_t const* goes;
  PLIANT_HOST_DEVICE Index operator()(Index i) const { return goes[i] != 0 ? 0 : 1; }
};
/// Leaves that arrive in blocks: sorted by these and, in each, in the order of the tree.
struct ArrivingLeaves {
  Index count;
  std::uint64_t const* keys;  // see LeavePlaces
  Index const* cells;

  /// The first that arrives in a block, or behind it.
  [[nodiscard]] PLIANT_HOST_DEVICE Index first_in(Index block) const {
    return lower_place(keys, count,
                       static_cast<std::uint64_t>(block) << LeavePlaces::bits_of_place);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Index block(Index k) const {
    return static_cast<Index>(keys[k] >> LeavePlaces::bits_of_place);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Index place_before(Index k) const {
    return static_cast<Index>(static_cast<std::uint32_t>(keys[k]));
  }
};
/// Puts leaves that stay, and those that arrive, where they stand now: among those of a block in the order of the tree. Places before
/// of the latter have no leaf, −1.
struct PutConverted {
  TreeOrder order;
  LeafBlocks blocks;  // before
  ArrivingLeaves arriving;
  std::uint8_t const* goes;
  Index const* start;  // by the place before: how many before it stay
  Index *before, *leaves, *places, *from;

  /// Of the leaf at a place before.
  PLIANT_HOST_DEVICE void put_staying(Index i) const {
    if (goes[i] != 0) return;
    Index const block = blocks.of(i), end = arriving.first_in(block + 1);
    Index low = arriving.first_in(block), high = end;
    while (low < high) {
      Index const middle = low + (high - low) / 2;
      if (order.precedes(arriving.cells[middle], before[i]))
        low = middle + 1;
      else
        high = middle;
    }
    put(start[i] + low, before[i], i);
  }
  PLIANT_HOST_DEVICE void put_arriving(Index k) const {
    Index const block = arriving.block(k), cell = arriving.cells[k];
    Index low = blocks.first[block], high = blocks.first[block + 1];
    while (low < high) {
      Index const middle = low + (high - low) / 2;
      if (order.precedes(before[middle], cell))
        low = middle + 1;
      else
        high = middle;
    }
    put(start[low] + k, cell, arriving.place_before(k));
  }

 private:
  PLIANT_HOST_DEVICE void put(Index place, Index cell, Index old) const {
    leaves[place] = cell;
    places[cell] = place;
    from[place] = old;
  }
};
struct PutStaying {
  PutConverted put;
  PLIANT_HOST_DEVICE void operator()(Index i) const { put.put_staying(i); }
};
struct PutArriving {
  PutConverted put;
  PLIANT_HOST_DEVICE void operator()(Index k) const { put.put_arriving(k); }
};
/// Takes leaves away from the places that they had.
struct ForgetLeaves {
  ArrivingLeaves arriving;
  Index* before;
  PLIANT_HOST_DEVICE void operator()(Index k) const { before[arriving.place_before(k)] = -1; }
};
/// Puts the first place of each block where that has come to, and tells it.
struct MoveBlocksOfConverted {
  ArrivingLeaves arriving;
  Index const* start;
  Index *first, *told;
  PLIANT_HOST_DEVICE void operator()(Index block) const {
    told[block] = first[block] = start[first[block]] + arriving.first_in(block);
  }
};

}  // namespace pliant::detail
