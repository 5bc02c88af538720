#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <pliant/backend/atomic.hpp>
#include <pliant/constraint/condition.hpp>
#include <pliant/topology/compaction_view.hpp>
#include <pliant/topology/refinement_results.hpp>
#include <pliant/topology/tree_view.hpp>

// Passes over sides of a tree that conditions hold, for loops of a backend. In the plane sides are edges.
namespace pliant::detail {

/// Which conditions on facets hold a side, a bit for each; the last one: some of its parts are held otherwise than others.
using ConditionBits = std::uint32_t;
inline constexpr std::size_t most_conditions = 31;
inline constexpr ConditionBits differs = ConditionBits{1} << most_conditions;

/// The sides of cells that have so many nodes.
template <int Dim, CellNodes Least, CellNodes Most>
struct SidesView {
  static constexpr int dim = Dim;
  TreeView tree;

  /// Calls visit(side) for the sides of a cell.
  template <class Visit>
  PLIANT_HOST_DEVICE void visit_sides(Index cell, Visit const& visit) const {
    auto const own = tree.row(cell);
    auto const& p = tree.cells[at(cell)].pattern();
    if constexpr (Dim == 2) {
      for (std::size_t e = 0; e < at(p.edges); ++e) visit(own.edges[e]);
    } else {
      for (std::size_t s = 0; s < at(p.sides); ++s) visit(own.sides[s]);
    }
  }
  /// Where the parts of a side begin; negative: it has none.
  [[nodiscard]] PLIANT_HOST_DEVICE Index first_part(Index side) const {
    if constexpr (Dim == 2)
      return tree.edges[at(side)].first_half;
    else
      return tree.sides[at(side)].first_child;
  }
  /// Into how many a divided side is.
  [[nodiscard]] PLIANT_HOST_DEVICE Index parts_of(Index side) const {
    if constexpr (Dim == 2)
      return 2;
    else
      return tree.parts_of(tree.sides[at(side)]);
  }
  /// Calls visit(node) for the nodes that facets have at a side.
  template <class Visit>
  PLIANT_HOST_DEVICE void visit_nodes(Index side, Visit const& visit) const {
    if constexpr (Dim == 2) {
      auto const& own = tree.edges[at(side)];
      for (Index const node : own.nodes) visit(node);
      if (nodes_on(side) != CellNodes::corners) visit(own.middle);
    } else {
      auto const& own = tree.sides[at(side)];
      auto const has = nodes_on(side);
      for (std::size_t k = 0; k < own.corners(); ++k) visit(tree.corner_of(own, k));
      if (has == CellNodes::corners) return;
      for (std::size_t k = 0; k < own.corners(); ++k) visit(tree.edges[at(own.edges[k])].middle);
      if (has == CellNodes::all && own.corners() == 4) visit(own.centre);
    }
  }

 private:
  static PLIANT_HOST_DEVICE std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] PLIANT_HOST_DEVICE CellNodes nodes_on(Index side) const {
    if constexpr (Least == Most)
      return Most;
    else
      return tree.nodes_of_facet<Dim>(side);
  }
};

/// In which directions conditions hold.
struct DirectionsOf {
  std::array<DirectionMask, most_conditions> of_condition{};

  /// Whether one of these conditions holds in all of some directions.
  [[nodiscard]] PLIANT_HOST_DEVICE bool hold(ConditionBits bits, DirectionMask directions) const {
    for (std::size_t c = 0; bits != 0 && c < most_conditions; ++c, bits >>= 1)
      if ((bits & 1) != 0 && (of_condition[c] & directions) == directions) return true;
    return false;
  }
  /// Which directions loops may hold one after the other so that nothing is missing, no more than `dim`: what conditions hold
  /// at once, or each by itself.
  [[nodiscard]] std::vector<DirectionMask> in_turn(int dim) const {
    std::vector<DirectionMask> masks;
    for (auto const mask : of_condition)
      if (mask != 0 && std::ranges::find(masks, mask) == masks.end()) masks.push_back(mask);
    if (masks.size() <= static_cast<std::size_t>(dim)) return masks;
    masks.clear();
    for (int k = 0; k < dim; ++k) masks.push_back(static_cast<DirectionMask>(1 << k));
    return masks;
  }
};

/// Parts of sides that were divided are held as these are. A call for each divided cell.
template <class Sides>
struct InheritConditions {
  Sides sides;
  CellSplit const* cells;
  ConditionBits* bits;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    sides.visit_sides(cells[r].cell, [&](Index side) {
      ConditionBits const own = bits[side];
      if (own == 0 || own == differs) return;
      Index const first = sides.first_part(side);
      if (first < 0) return;
      for (Index k = 0; k < sides.parts_of(side); ++k) bits[first + k] = own;
    });
  }
};
/// Holds the nodes of the parts of held sides of refined cells in some directions, the same for all of them: then all
/// that is written to a byte at once is the same.
template <class Sides>
struct HoldParts {
  Sides sides;
  CellSplit const* cells;
  ConditionBits const* bits;
  DirectionsOf conditions;
  DirectionMask directions;
  Index const* of_node;
  DirectionMask* held;  // by row

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    sides.visit_sides(cells[r].cell, [&](Index side) {
      if (bits[side] == differs || !conditions.hold(bits[side], directions)) return;
      Index const first = sides.first_part(side);
      if (first < 0) return;
      for (Index k = 0; k < sides.parts_of(side); ++k)
        sides.visit_nodes(first + k, [&](Index node) {
          auto& own = held[of_node[node]];
          own = static_cast<DirectionMask>(own | directions);
        });
    });
  }
};
/// The same for all sides without parts.
template <class Sides>
struct HoldSides {
  Sides sides;
  ConditionBits const* bits;
  DirectionsOf conditions;
  DirectionMask directions;
  Index const* of_node;
  DirectionMask* held;  // by row

  PLIANT_HOST_DEVICE void operator()(Index side) const {
    if (bits[side] == 0 || sides.first_part(side) >= 0) return;
    if (!conditions.hold(bits[side], directions)) return;
    sides.visit_nodes(side, [&](Index node) {
      auto& own = held[of_node[node]];
      own = static_cast<DirectionMask>(own | directions);
    });
  }
};

struct ClearBits {
  ConditionBits* bits;
  PLIANT_HOST_DEVICE void operator()(Index side) const { bits[side] = 0; }
};
/// Of sides from numbers.first on: to[new number] = from[old number] of those that stay.
struct MoveBits {
  NewNumbers numbers;
  ConditionBits const* from;  // by side
  ConditionBits* to;          // from that on
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    Index const side = numbers.first + k;
    if (Index const now = numbers(side); now >= 0) to[now - numbers.first] = from[side];
  }
};
/// Notes where a merged side would have parts that are held otherwise than others.
template <class Sides>
struct FindCutSides {
  Sides sides;
  NewNumbers cells;
  Index const* parents;  // old numbers of merged cells
  ConditionBits const *bits, *moved;
  Index first;  // of sides, those from here on are moved
  Index* found;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    sides.visit_sides(cells(parents[r]), [&](Index side) {
      ConditionBits const own = side < first ? bits[side] : moved[side - first];
      if (own == differs && sides.first_part(side) < 0) atomic_store(*found, 1);
    });
  }
};
/// Notes where a node goes that a condition on nodes names.
struct FindNamedNodes {
  Index const* numbers;       // new, of nodes from `first` on; −1: gone
  Index const* of_node;       // from the same on
  std::uint8_t const* named;  // by row
  Index* found;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    if (numbers[k] < 0 && named[of_node[k]] != 0) atomic_store(*found, 1);
  }
};

}  // namespace pliant::detail
