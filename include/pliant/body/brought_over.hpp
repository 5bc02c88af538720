#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/body/topology_on.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/facets_between.hpp>
#include <pliant/topology/hierarchy.hpp>

// What the host knows of a mesh that was changed in a backend's memory, from what there is then: in place of making all changes on
// the host, too.
namespace pliant::detail {

/// Conditions and pressures of one tree as another one has them; nothing where FacetsBetween gives nothing. Nodes that conditions
/// name keep their numbers: they are of the initial mesh.
template <int Dim>
std::optional<Prescribed<Dim>> taken_over(Prescribed<Dim> prescribed,
                                          FacetsBetween<Dim> const& between, Index initial_nodes) {
  for (auto& pressure : prescribed.pressures) {
    auto facets = between.carry(pressure.facets);
    if (!facets) return std::nullopt;
    pressure.facets = std::move(*facets);
  }
  for (auto& condition : prescribed.conditions) {
    if (condition.facets.empty()) {
      for (Index const node : condition.nodes)
        if (node >= initial_nodes) return std::nullopt;
      continue;
    }
    auto facets = between.carry(condition.facets);
    if (!facets) return std::nullopt;
    if (*facets == condition.facets) continue;
    condition.facets = std::move(*facets);
    condition.nodes = nodes_of(condition.facets);
  }
  return prescribed;
}

/// The topology of a body without values per element, and what is prescribed there, by what a backend's memory has of it; `on`
/// has an earlier one of the host. Nothing where facets or nodes are prescribed that may have come and gone.
template <class M, Backend B>
std::optional<MeshOnHost<M>> brought_over(TopologyOn<M, B>& on) {
  constexpr int dim = M::dim;
  auto const& [earlier, prescribed_before] = on.on_host.known;
  HostThreads const threads(*earlier);
  auto const& like = on.on_host.tree->tree();

  std::vector<CellSet> leaves;
  for (auto const& numbers : on.numbers) leaves.push_back(numbers.leaves());
  auto lists = on.tree.lists(like.lists(), leaves);
  std::vector<typename FacetsBetween<dim>::Facets const*> facets;
  for (auto const& [name, list] : earlier->boundaries()) facets.push_back(list.get());
  for (auto const& condition : prescribed_before->conditions) facets.push_back(&condition.facets);
  for (auto const& pressure : prescribed_before->pressures) facets.push_back(&pressure.facets);
  FacetsBetween<dim> const between(like.lists(), lists, facets);
  std::map<std::string, typename Topology<M>::Facets> boundaries;
  for (auto const& [name, list] : earlier->boundaries()) {
    auto carried = between.carry(*list);
    if (!carried) return std::nullopt;
    boundaries.emplace(name, std::make_shared<std::vector<Facet<dim>> const>(std::move(*carried)));
  }
  auto prescribed = taken_over(*prescribed_before, between, lists.initial.nodes);
  if (!prescribed) return std::nullopt;

  auto points = on.on_host.tree->points();
  auto const first = static_cast<std::size_t>(lists.initial.nodes);
  auto const row_of = on.rows.download_all().of_node;
  auto const values = download<double>(on.points);
  points.replace_from(first, static_cast<std::size_t>(lists.nodes) - first, [&](std::size_t k) {
    auto const* const from =
        values.data() + node_stride * static_cast<std::size_t>(row_of[first + k]);
    Point<dim> point;
    std::copy_n(from, dim, point.begin());
    return point;
  });
  auto tree = std::make_shared<Hierarchy<dim> const>(
      std::move(points), CellTree<dim>(std::move(lists), like.cells_at_edges()));
  auto topology = std::make_shared<Topology<M>>(std::move(tree), std::move(leaves));
  topology->set_boundaries(boundaries, [](auto const& list) { return list; });
  topology->element_values.resize(on.numbers.size());
  return MeshOnHost<M>{std::move(topology),
                       std::make_shared<Prescribed<dim> const>(std::move(*prescribed))};
}

}  // namespace pliant::detail
