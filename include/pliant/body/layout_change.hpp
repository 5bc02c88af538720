#pragma once

#include <algorithm>
#include <cstddef>
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
  std::vector<std::pair<Index, std::size_t>> order;  // of families, by their places
  order.reserve(places_of_families.size());
  for (std::size_t f = 0; f < places_of_families.size(); ++f)
    order.emplace_back(places_of_families[f], f);
  std::ranges::sort(order);
  for (auto const& own : order) {
    Index const region = own.first / cells_per_region;
    families_after.visit_all(own.second, [&](auto, auto const& nodes) {
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
  auto [rows, freed] =
      rows_after(change.before.node_rows, change.transfer, change.touched.families_after(), places);
  auto const changed = changed_blocks(first, places);
  OrderBefore<sizeof...(Es), Mesh<Es...>::dim> before{{}, change.transfer, changed};
  std::apply([&](auto const&... table) { before.cells = {table.numbers.blocks()...}; },
             change.before.tables);
  auto ordered = elements_in_order(topology, first, &before);
  for (std::size_t type = 0; type < sizeof...(Es); ++type)
    ordered.blocks[type].first_before = change.before.first_of_block[type];
  return {std::move(ordered), std::move(rows), std::move(freed)};
}

}  // namespace pliant::detail
