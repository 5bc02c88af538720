#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/backend/element_blocks.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/body/cell_order.hpp>
#include <pliant/body/numbering.hpp>
#include <pliant/body/touched_elements.hpp>

// What a layout takes from the one before a change of topology.
namespace pliant::detail {

/// The layout L before a change, and what the change means.
template <class L, class M>
struct LayoutChange {
  L const& before;
  Transfer<M::dim> const& transfer;
  TouchedElements<M> const& touched;
};

/// The numbering of a topology, and the blocks that its elements are in. `first`: the order of the body's first mesh; null:
/// this is it. `change`: null where there was none.
template <class L, Element... Es>
std::pair<Numbering<Es...>, std::array<ElementBlocks, sizeof...(Es)>> numbered(
    Topology<Mesh<Es...>> const& topology, CellOrder const* first,
    LayoutChange<L, Mesh<Es...>> const* change) {
  auto const& mesh = topology.mesh;
  if (first == nullptr || !topology.tree) return {Numbering<Es...>(mesh), first_blocks(mesh)};
  OrderedElements<sizeof...(Es)> ordered;
  ChangedBlocks changed;
  if (change != nullptr) {
    changed = changed_blocks(topology, *first, change->transfer, change->touched);
    auto const before = change->before.order(change->transfer, changed.elements);
    ordered = elements_in_order(topology, *first, &before);
  } else {
    ordered = elements_in_order(topology, *first);
  }
  auto const keeps_nodes = [&](std::size_t block) {
    return change != nullptr && !change->before.first_nodes[0].empty() && changed.nodes[block] == 0;
  };
  auto const number_kept = [&](std::size_t type, std::size_t block, auto const& take) {
    auto const& before = change->before;
    auto const& first_node = before.first_nodes[type];
    for (auto old = static_cast<std::size_t>(first_node[block]);
         old < static_cast<std::size_t>(first_node[block + 1]); ++old)
      take(change->transfer.renumbered(before.user_node[old]));
  };
  Numbering<Es...> numbering(mesh, std::move(ordered.elements), ordered.blocks, keeps_nodes,
                             number_kept);
  return {std::move(numbering), std::move(ordered.blocks)};
}

/// What has become of the nodes before a change, by the internal number there; −1: gone. `internal_node`: after it.
template <class L, class M>
std::vector<Index> nodes_now(LayoutChange<L, M> const& change,
                             std::vector<Index> const& internal_node) {
  auto const& before = change.before;
  std::vector<Index> now(before.user_node.size());
  for_each_on_host(before.nodes, 16384, [&](Index old) {
    Index const user = change.transfer.renumbered(before.user_node[static_cast<std::size_t>(old)]);
    now[static_cast<std::size_t>(old)] =
        user < 0 ? Index{-1} : internal_node[static_cast<std::size_t>(user)];
  });
  return now;
}

}  // namespace pliant::detail
