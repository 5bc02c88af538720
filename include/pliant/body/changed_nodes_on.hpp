#pragma once

#include <cstddef>
#include <memory>

#include <pliant/backend/backend.hpp>
#include <pliant/math/uncontracted.hpp>
#include <pliant/topology/compaction_view.hpp>
#include <pliant/topology/tree_on.hpp>

// What becomes of nodes in a change of a mesh that is made in a backend's memory.
namespace pliant {

namespace detail {

/// Nodes of a mesh that was changed in a backend's memory: those that stay, and behind them those that a refinement made, or raising.
template <Backend B>
struct ChangedNodesOn {
  Index before = 0, now = 0;  // how many there were, and are
  Index first_moved = 0;      // the first that may have another number or be gone
  std::shared_ptr<typename B::template Array<Index>>
      numbers{};    // from that one on; null: all keep theirs
  TreeView tree{};  // with the new nodes
  Index new_nodes = 0;
  PlacedNode const* made = nullptr;  // (new_nodes)

  [[nodiscard]] NewNumbers new_numbers() const {
    return {numbers ? first_moved : before, numbers ? numbers->data() : nullptr};
  }
};

/// Gives nodes that stay the values that they had.
template <class U>
struct MoveNodeValues {
  NewNumbers numbers;
  std::ptrdiff_t components;
  U const* before;
  U* now;
  PLIANT_HOST_DEVICE void operator()(Index node) const {
    Index const to = numbers(node);
    if (to < 0) return;
    for (std::ptrdiff_t c = 0; c < components; ++c)
      now[components * to + c] = before[components * node + c];
  }
};
/// Gives a new node the weighted sums of the values that the nodes have that its cell had: see Transfer::fill_new_nodes.
template <Element E, class U>
struct CarryNewNodes {
  TreeView tree;
  PlacedNode const* nodes;
  bool has_others;  // whether they may lie in cells of other types
  std::ptrdiff_t components;
  U* values;

  PLIANT_HOST_DEVICE void operator()(Index k) const {
    PlacedNode const& placed = nodes[k];
    if (!cells_of_type<E>(has_others).made(tree, placed)) return;
    Vector<double, E::dim> xi;
    for (int d = 0; d < E::dim; ++d) xi[d] = placed.place[static_cast<std::size_t>(d)];
    auto const weights = E::shape(xi);
    auto const parents = tree.nodes_of(placed.cell);
    for (std::ptrdiff_t c = 0; c < components; ++c) {
      U first{};
      Uncontracted sum = 0.0;
      bool same = true, none = true;  // what all have is not rounded
      for (int a = 0; a < E::nodes; ++a) {
        if (weights[a] == 0) continue;
        U const value = values[components * parents[static_cast<std::size_t>(a)] + c];
        if (none) first = value;
        none = false;
        same = same && value == first;
        sum += Uncontracted(weights[a]) * Uncontracted(value);
      }
      values[components * placed.node + c] = same ? first : static_cast<U>(sum.value);
    }
  }
};

}  // namespace detail

}  // namespace pliant
