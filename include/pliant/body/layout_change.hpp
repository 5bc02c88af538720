#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include <pliant/body/cell_order.hpp>
#include <pliant/body/node_rows.hpp>
#include <pliant/body/touched_elements.hpp>

// What a layout takes from the one before a change of topology.
namespace pliant::detail {

/// The layout L before a change, and what the change means. `looked_at`: nodes by the new number, among them all of
/// which the mass may be another.
template <class L, class M>
struct LayoutChange {
  L const& before;
  Transfer<M::dim> const& transfer;
  TouchedElements<M> const& touched;
  std::vector<Index> const& looked_at;
};

/// The rows of nodes after a change, and those that were a node's and are free now. New nodes have rows near those of
/// others that are made from near cells of the first mesh.
template <class M>
std::pair<NodeRows, std::vector<Index>> rows_after(NodeRows const& before,
                                                   Transfer<M::dim> const& transfer,
                                                   FamilyNodes<M> const& families_after,
                                                   std::vector<Index> const& places_of_families) {
  constexpr Index cells_per_region = 16 * cells_per_block;
  ChangedNodeRows rows(before, transfer);
  // Of families, by their places: those in the upper half of a number.
  std::vector<std::uint64_t> order(places_of_families.size());
  for (std::size_t f = 0; f < order.size(); ++f)
    order[f] = static_cast<std::uint64_t>(places_of_families[f]) << 32 | f;
  std::ranges::sort(order);
  for (std::uint64_t const own : order) {
    auto const family = static_cast<std::size_t>(own & 0xffffffff);
    Index const region = static_cast<Index>(own >> 32) / cells_per_region;
    families_after.visit_all(family, [&](auto, auto const& nodes) {
      for (Index const node : nodes)
        if (node >= transfer.staying_nodes()) rows.give(node, region);
    });
  }
  for (NewNode const& made : transfer.new_nodes()) rows.give(made.node, 0);
  return std::move(rows).finish();
}

/// The order of elements after a change, the rows of nodes, and rows that are free now: most of both as before.
template <class L, Element... Es>
std::tuple<OrderedElements<sizeof...(Es)>, NodeRows, std::vector<Index>> order_after(
    Topology<Mesh<Es...>> const& topology, CellOrder const& first,
    LayoutChange<L, Mesh<Es...>> const& change) {
  auto const places = places_of_families(topology, first, change.transfer);
  auto [rows, freed] = rows_after(change.before.node_rows(), change.transfer,
                                  change.touched.families_after(), places);
  auto const changed = changed_blocks(first, places);
  OrderBefore<sizeof...(Es)> before{{}, changed};
  std::apply([&](auto const&... table) { before.cells = {table.numbers->blocks()...}; },
             change.before.tables);
  auto ordered = elements_in_order(topology, first, &before);
  for (std::size_t type = 0; type < sizeof...(Es); ++type)
    ordered.blocks[type].first_before = change.before.first_of_block[type];
  return {std::move(ordered), std::move(rows), std::move(freed)};
}

}  // namespace pliant::detail
