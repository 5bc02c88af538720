#pragma once

#include <cstddef>
#include <cstdint>

#include <pliant/body/converted_family.hpp>
#include <pliant/body/leaf_order_passes.hpp>
#include <pliant/body/node_row_passes.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/tets_of_pyramids.hpp>
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
/// Notes the places that leaves go away from, those that come for them, and keys by which these are sorted: their blocks and, in each, the
/// places from which they come.
struct LeavePlaces {
  static constexpr int bits_of_sibling = 4, bits_of_place = 32 + bits_of_sibling;
  static constexpr std::uint8_t none = 255;
  LeafBlocks blocks;
  Index const* other_block;  // by block: that of the same cells of the other type
  Index const* places;       // by cell
  std::uint8_t* in_place;    // see LeavesThere
  std::uint64_t* keys;
  Index* arriving;
  ConvertedFamily* families;

  /// Of family r, of which the first that comes is listed at `to`.
  PLIANT_HOST_DEVICE void leave(Index r, ConvertedFamily const& family, Index to) const {
    families[r] = family;
    for (Index k = 0; k < family.gone; ++k) in_place[family.first_before + k] = none;
    Index const block = blocks.of(family.first_before);
    for (Index k = 0; k < family.come; ++k)
      list(to + k, family.cell + k, other_block[block], family.first_before, k);
  }
  /// A leaf that arrives in a block for others at a place, among siblings.
  PLIANT_HOST_DEVICE void list(Index to, Index cell, Index block, Index place,
                               Index sibling) const {
    static_assert(RefinementPattern::most_children <= 1u << bits_of_sibling);
    keys[to] = static_cast<std::uint64_t>(block) << bits_of_place |
               static_cast<std::uint64_t>(place) << bits_of_sibling |
               static_cast<std::uint64_t>(sibling);
    arriving[to] = cell;
  }
};
/// Leaves of another degree.
struct LeaveConverted : LeavePlaces {
  Index const* cells;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    leave(r, {cells[r], 1, places[cells[r]], 1}, r);
  }
};
/// Leaves that were split.
struct LeaveSplit : LeavePlaces {
  CellSplit const* cells;
  LeafParts const* parts;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    auto const& own = parts[r];
    leave(r, {own.cell, own.cells, places[cells[r].cell], 1}, own.cell - parts[0].cell);
  }
};
/// Leaves into which others were split, which are merged.
struct LeaveMerged : LeavePlaces {
  Merged of;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    Index const cell = new_cells(of)(of.parents[r]);
    leave(r, {cell, 1, places[of.first_children[r]], of.children[r]}, r);
  }
};
/// Leaves that were refined, of a tree with pyramids, whose tetrahedra stand so many blocks behind them, and others' children in their
/// place. So many arrive for each; where there are none, −1 behind all others.
struct LeaveRefined : LeavePlaces {
  TreeView tree;
  CellSplit const* cells;
  LeafParts const* parts;
  Index blocks_to_tets;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    auto const& own = parts[r];
    Index const place = places[cells[r].cell], block = blocks.of(place),
                same = children_of_own_type(tree.cells[static_cast<std::size_t>(cells[r].cell)]);
    in_place[place] = static_cast<std::uint8_t>(same);
    bool const has_tets = same < own.cells;
    for (Index k = 0; k < tets_of_pyramid; ++k)
      if (has_tets)
        list(tets_of_pyramid * r + k, own.cell + same + k, block + blocks_to_tets, place, k);
      else
        list(tets_of_pyramid * r + k, -1, blocks.count, 0, 0);
    families[r] = has_tets ? ConvertedFamily{own.cell + same, own.cells - same, place, 1}
                           : ConvertedFamily{own.cell, 0, -1, 0};
  }
};
/// Children that were merged, of such a tree.
struct LeaveCoarsened : LeavePlaces {
  TreeView tree;
  Coarsened of;
  MergedFamily* merged;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    Index const cell = new_cells(of)(of.parents[r]), first = of.first_children[r],
                place = places[first];
    auto const& parent = tree.cells[static_cast<std::size_t>(cell)];
    Index const children = parent.pattern().children, same = children_of_own_type(parent);
    for (Index k = 0; k < children; ++k) in_place[places[first + k]] = none;
    list(r, cell, blocks.of(place), place, 0);
    merged[r] = {cell, -1, place, same};
    families[r] = same < children ? ConvertedFamily{cell, 1, places[first + same], children - same}
                                  : ConvertedFamily{cell, 0, -1, 0};
  }
};
struct FindMergedPlaces {
  MergedFamily* families;
  Index const* places;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    families[r].place = places[families[r].cell];
  }
};
/// How many leaves stand in the place of one that are of its type: itself, none, or so many children.
struct LeavesThere {
  static constexpr std::uint8_t itself = 0, none = LeavePlaces::none;
  std::uint8_t const* in_place;
  PLIANT_HOST_DEVICE Index operator()(Index i) const {
    return in_place[i] == itself ? 1 : in_place[i] == none ? 0 : Index{in_place[i]};
  }
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
    return static_cast<Index>(static_cast<std::uint32_t>(keys[k] >> LeavePlaces::bits_of_sibling));
  }
};
/// Puts leaves that stay, or whose children stand in their place, and those that arrive, where they stand now: among those of a block in the
/// order of the tree. Places before of leaves that went have none, −1; the others have the new numbers of theirs.
struct PutConverted {
  TreeOrder order;
  LeafBlocks blocks;  // before
  ArrivingLeaves arriving;
  NewNumbers cells;
  LeavesThere there;
  Index const* start;  // by the place before: how many stand there before it
  Index* staying;      // those that stand there, in their order
  Index *before, *leaves, *places, *from;

  /// Of the leaf at a place before, one function after the other.
  PLIANT_HOST_DEVICE void list_staying(Index i) const {
    Index const count = there(i), cell = count == 0 ? -1 : cells(before[i]);
    before[i] = cell;
    Index const first = count == 0 || there.in_place[i] == LeavesThere::itself
                            ? cell
                            : order.tree.cells[static_cast<std::size_t>(cell)].first_child;
    for (Index k = 0; k < count; ++k) staying[start[i] + k] = first + k;
  }
  PLIANT_HOST_DEVICE void put_staying(Index i) const {
    Index const block = blocks.of(i), end = start[i] + there(i);
    for (Index at = start[i]; at < end; ++at)
      put(at + count_before(staying[at], arriving.cells, arriving.first_in(block),
                            arriving.first_in(block + 1)),
          staying[at], i);
  }
  PLIANT_HOST_DEVICE void put_arriving(Index k) const {
    Index const block = arriving.block(k), cell = arriving.cells[k];
    if (cell < 0) return;
    Index const stay =
        count_before(cell, staying, start[blocks.first[block]], start[blocks.first[block + 1]]);
    put(stay + k, cell, arriving.place_before(k));
  }

 private:
  /// Where a leaf would stand among those from `low` to `high` of a list.
  [[nodiscard]] PLIANT_HOST_DEVICE Index count_before(Index cell, Index const* list, Index low,
                                                      Index high) const {
    while (low < high) {
      Index const middle = low + (high - low) / 2;
      if (order.precedes(list[middle], cell))
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  }
  PLIANT_HOST_DEVICE void put(Index place, Index cell, Index old) const {
    leaves[place] = cell;
    places[cell] = place;
    from[place] = old;
  }
};
struct ListStayingLeaves {
  PutConverted put;
  PLIANT_HOST_DEVICE void operator()(Index i) const { put.list_staying(i); }
};
struct PutStaying {
  PutConverted put;
  PLIANT_HOST_DEVICE void operator()(Index i) const { put.put_staying(i); }
};
struct PutArriving {
  PutConverted put;
  PLIANT_HOST_DEVICE void operator()(Index k) const { put.put_arriving(k); }
};
/// Puts the first place of each block where that has come to, and tells it and how many leaves before it stay.
struct MoveBlocksOfConverted {
  ArrivingLeaves arriving;
  Index const* start;
  Index *first, *told, *told_staying;
  PLIANT_HOST_DEVICE void operator()(Index block) const {
    Index const stay = start[first[block]];
    told_staying[block] = stay;
    told[block] = first[block] = stay + arriving.first_in(block);
  }
};

}  // namespace pliant::detail
