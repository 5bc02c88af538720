#pragma once

#include <cstddef>
#include <cstdint>

#include <pliant/body/held_passes.hpp>

// Passes over facets of a mesh, as sides of its tree, for loops of a backend.
namespace pliant::detail {

/// Marks the nodes at sides of a set that have no parts.
template <class Sides>
struct MarkNodesOfSet {
  Sides sides;
  ConditionBits const* bits;
  ConditionBits set;
  Index const* of_node;
  std::uint8_t* marks;  // by row

  PLIANT_HOST_DEVICE void operator()(Index side) const {
    if ((bits[side] & set) == 0 || sides.first_part(side) >= 0) return;
    sides.visit_nodes(side, [&](Index node) { atomic_store(marks[of_node[node]], 1); });
  }
};
/// Which sides of a tree belong to a set.
template <class Sides>
struct SidesInSet {
  Sides sides;
  ConditionBits const* bits;
  ConditionBits set;

  /// Of side s of a cell; of an edge in the plane.
  PLIANT_HOST_DEVICE bool operator()(Index c, Index s) const {
    auto const own = sides.tree.row(c);
    Index const side = Sides::dim == 2 ? own.edges[s] : own.sides[s];
    return (bits[side] & set) != 0;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE TreeCell const& cell(Index c) const {
    return sides.tree.cells[at(c)];
  }

 private:
  static PLIANT_HOST_DEVICE std::size_t at(Index i) { return static_cast<std::size_t>(i); }
};
/// Whether the leaf at a place has a side in a set.
template <class Sides>
struct HasSideInSet {
  SidesInSet<Sides> in_set;
  Index const* leaves;

  PLIANT_HOST_DEVICE bool operator()(Index place) const {
    auto const& p = in_set.cell(leaves[place]).pattern();
    for (Index s = 0; s < (Sides::dim == 2 ? p.edges : p.sides); ++s)
      if (in_set(leaves[place], s)) return true;
    return false;
  }
};
/// Whether side i % Count of a listed cell, i / Count, is in a set, and has so many corners.
template <class Sides, Index Count, int Corners>
struct SidesOfCells {
  SidesInSet<Sides> in_set;
  Index const* cells;

  PLIANT_HOST_DEVICE bool operator()(Index i) const {
    Index const cell = cells[i / Count], side = i % Count;
    return in_set(cell, side) &&
           (Sides::dim == 2 || in_set.cell(cell).pattern().corners_of_side(side) == Corners);
  }
};
/// Puts the rows of the nodes of a listed side, as they are seen from outside of its element.
template <CellNodes Has, class Sides, Index Count, int Corners, int Width>
struct PutFacet {
  SidesOfCells<Sides, Count, Corners> of_cells;
  Index const* places;  // as SidesOfCells counts
  Index const* of_node;
  Index* rows;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const number = of_cells.cells[places[k] / Count];
    auto const& cell = of_cells.in_set.cell(number);
    auto const& sides = of_cells.in_set.sides;
    auto const& tree = sides.tree;
    auto const row = tree.row(number);
    auto const s = static_cast<std::size_t>(places[k] % Count);
    auto const& p = cell.pattern();
    auto const at = [](Index i) { return static_cast<std::size_t>(i); };
    auto next = std::ptrdiff_t{Width} * k;
    auto const put = [&](Index node) { rows[next++] = of_node[node]; };
    for (int a = 0; a < Corners; ++a) {
      auto const c = at(cell.mirrored ? Corners - 1 - a : a);
      put(row.nodes[at(Sides::dim == 2 ? p.edge[s][c] : p.side[s][c])]);
    }
    if (Has == CellNodes::corners) return;
    if constexpr (Sides::dim == 2) {
      put(tree.edges[at(row.edges[s])].middle);
    } else {
      for (int a = 0; a < Corners; ++a) {  // each between corners a and a + 1
        auto const c = at(cell.mirrored ? (2 * Corners - 2 - a) % Corners : a);
        put(tree.edges[at(row.edges[at(p.edges_of_side[s][c])])].middle);
      }
      if (Has == CellNodes::all && Corners == 4) put(tree.sides[at(row.sides[s])].centre);
    }
  }
};

}  // namespace pliant::detail
