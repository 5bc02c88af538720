#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/error.hpp>
#include <pliant/topology/transfer.hpp>
#include <pliant/topology/tree_cell.hpp>

// What changes of a Hierarchy did, and how far they may go.
namespace pliant {

/// What a call of Hierarchy::refine did.
template <int Dim>
struct Refinement {
  std::vector<Index> parents;             ///< refined cells, closure included, coarser ones first
  WeightedNodes new_nodes;                ///< ascending; they follow the nodes that were there
  std::vector<DividedFacet<Dim>> facets;  ///< sides that were divided, in the plane edges
};

/// What a call of Hierarchy::raise or split did.
struct AddedNodes {
  WeightedNodes new_nodes;  ///< ascending; they follow the nodes that were there
};

/// What a call of Hierarchy::coarsen or merge did.
template <int Dim>
struct Coarsening {
  std::vector<Index> parents;  ///< cells that are leaves again, by their new number, ascending
  Renumbering renumbered;      ///< nodes and cells
  WeightedNodes gone;  ///< nodes that went, and between which nodes that stayed; old numbers
  std::vector<DividedFacet<Dim>> facets;  ///< sides that are whole again; old numbers
};

/// What a call of TreeOn::coarsen did: lists in the backend's memory, until the tree changes again.
struct Coarsened {
  Index merged = 0;                ///< how many cells are leaves again; of none, there are no lists
  Index const* parents = nullptr;  ///< (merged): these, by their old numbers, ascending
  /// (merged): the old number of the first child of each; the others followed it.
  Index const* first_children = nullptr;
  TreeSizes staying;      ///< so many of each, the first, keep their numbers
  TreeSizes before, now;  ///< how many there were, and are
  /// (before.nodes - staying.nodes): the new number of node staying.nodes + k is nodes[k]; −1: gone.
  Index const* nodes = nullptr;
  Index const* cells = nullptr;  ///< (before.cells - staying.cells): the same for cells
  Index const* edges = nullptr;  ///< and edges
  Index const* sides = nullptr;  ///< and sides
};

/// Which nodes elements on cells of each kind get; corners only on kinds that are not named.
struct NodesOfKinds {
  std::array<CellNodes, 6> by_kind{};
  bool raises = true;  ///< leaves that have corners only; else those that have others

  PLIANT_HOST_DEVICE CellNodes of_kind(CellKind kind) const {
    return by_kind[static_cast<std::size_t>(kind)];
  }
  /// Whether a leaf gets others than it has.
  PLIANT_HOST_DEVICE bool converts(TreeCell const& cell) const {
    if (raises) return cell.has == CellNodes::corners && of_kind(cell.kind) != CellNodes::corners;
    return cell.has != CellNodes::corners;
  }
};
/// What a call of TreeOn::raise did: lists in the backend's memory, until the tree changes again.
struct Raised {
  Index raised = 0;                   ///< how many cells got nodes between their corners
  Index const* cells = nullptr;       ///< (raised): these, ascending
  Index new_nodes = 0;                ///< nodes that nobody had
  PlacedNode const* nodes = nullptr;  ///< (new_nodes), in the order of their numbers
};
/// What a call of TreeOn::lower did: nodes between corners went that no other leaf has. All cells, edges and sides keep their
/// numbers.
struct Lowered : Coarsened {
  Index lowered = 0;                     ///< how many cells have corners only now
  Index const* lowered_cells = nullptr;  ///< (lowered): these, ascending
};
/// What a call of TreeOn::merge did: as of TreeOn::coarsen, of cells that were split.
struct Merged : Coarsened {
  Index const* children = nullptr;  ///< (merged): how many leaves each was split into
};

namespace detail {
inline void check_max_level(char const* where, int max_level) {
  if (max_level < 0 || max_level > most_levels)
    throw Error(where, ": a max_level of ", max_level, "; give at least 0 and at most ",
                most_levels);
}
/// Of so many cells that take too much.
[[noreturn]] inline void refuse_division(char const* verb, Index cells, char const* what,
                                         std::size_t in_all, std::size_t limit) {
  throw Error(verb, ": to ", verb, " ", cells, " cells, coarser neighbours included, takes ",
              in_all, " ", what, " in all, and the limit is ", limit,
              "; mark fewer cells or raise the limit");
}
[[noreturn]] inline void refuse_raising(std::size_t cells, std::size_t nodes, std::size_t limit) {
  throw Error("raise: to raise the degree of ", cells, " cells takes ", nodes,
              " nodes in all, and the limit is ", limit, "; mark fewer cells or raise the limit");
}
}  // namespace detail

/// Beyond what Hierarchy::refine throws Error, or leaves cells alone.
struct RefinementLimits {
  std::size_t nodes = std::numeric_limits<std::size_t>::max();   ///< most nodes in all
  std::size_t leaves = std::numeric_limits<std::size_t>::max();  ///< most leaves in all
  /// Marked cells of this level, 0 to most_levels, are left alone. Beyond some 40 levels double coordinates of order
  /// one no longer tell nodes apart.
  int max_level = 30;
};

}  // namespace pliant
