#pragma once

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <pliant/constraint/interpolation.hpp>
#include <pliant/topology/element_changes.hpp>
#include <pliant/topology/marked_elements.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

// From marked elements to another topology and the transfer to it, without a body.
namespace pliant {

/// A change of topology that is ready to be made; nothing has changed yet.
template <class M>
struct TopologyPlan {
  std::shared_ptr<Topology<M> const> before, after;
  Transfer<M::dim> transfer;
  // Elements that are divided into smaller ones, those included that keep neighbours within one level; that took the
  // place of such children; of another degree; split into others; and that took the place of those.
  struct Counts {
    std::size_t refined = 0, coarsened = 0, raised = 0, lowered = 0, split = 0, merged = 0;
  };
  Counts counts;
};

/// Plans a change of a topology: marked elements are refined or split, families of which all are marked merged, and degrees
/// raised and lowered. Neighbours differ by one level at most: what is coarser beside an element to divide is divided too,
/// and a family stays where it would become too coarse, or where `kept` says so, as do the nodes between corners that it
/// names. What is divided or merged keeps its degree. Empty where nothing changes. Throws Error where an element is
/// unknown, cannot be raised, lowered, split or merged, or a limit would be exceeded.
template <class M>
auto plan_change(std::shared_ptr<Topology<M> const> const& before, MarkedElements const& marked,
                 RefinementLimits const& limits, KeptParts<M::dim> const& kept,
                 ElementValues<M::dim> const& values) -> std::optional<TopologyPlan<M>> {
  constexpr int dim = M::dim;
  auto const check = [&](char const* verb, std::vector<std::vector<Index>> const& lists) {
    if (!lists.empty()) detail::check_lists(before->mesh, verb, lists);
  };
  check("refine", marked.refine);
  check("coarsen", marked.coarsen);
  check("raise", marked.raise);
  check("lower", marked.lower);
  check("split", marked.split);
  check("split", marked.split_in_two);
  check("merge", marked.merge);
  if (marked.none()) return std::nullopt;
  auto const old = detail::tree_of(before);
  auto changes = detail::changes_of(before->mesh, old, marked);
  if (changes.none()) return std::nullopt;
  auto changed = detail::change_cells(*old.tree, changes, limits);
  while (detail::take_back(*old.tree, changes, changed, kept))
    changed = detail::change_cells(*old.tree, changes, limits);
  if (changes.families.empty() && changed.refinement.parents.empty() && changed.converted.empty() &&
      changed.split.empty())
    return std::nullopt;

  auto new_nodes = std::move(changed.refinement.new_nodes);
  std::ranges::move(changed.added, std::back_inserter(new_nodes));
  auto converted = changed.converted;
  for (Index& c : converted) c = changed.renumbered(c);
  std::ranges::move(changed.tree->whole_facets(converted),
                    std::back_inserter(changed.refinement.facets));
  typename Transfer<dim>::Parts parts{
      .old_nodes = static_cast<Index>(before->mesh.nodes.size()),
      .renumbered = std::move(changed.coarsening.renumbered.nodes),
      .new_nodes = std::move(new_nodes),
      .gone = std::move(changed.coarsening.gone),
      .old_elements = detail::element_counts(before->mesh),
      .divided = std::move(changed.refinement.facets),
      .merged = std::move(changed.coarsening.facets),
  };
  auto topology = std::make_shared<Topology<M>>();
  M& mesh = topology->mesh;
  mesh.nodes = changed.tree->points();
  Index const first_moved = changed.coarsening.renumbered.first_node;
  detail::ElementChanges<M> element_changes(mesh, *old.cells, *old.tree, changes.families, changed);
  detail::for_each_type_of(mesh, [&]<Element E>(E, std::size_t type) {
    auto changed_elements = element_changes.template of<E>(type);
    auto& elements = mesh.template elements<E>();
    elements.reserve(changed_elements.cells.size());
    for (auto const& origin : changed_elements.origins) {
      auto const first = elements.size();
      if (origin.child == Transfer<dim>::Origin::same) {
        auto const from = before->mesh.template elements<E>().begin() + origin.element;
        elements.insert(elements.end(), from, from + origin.count);
        if (parts.renumbered.empty()) continue;
        for (auto e = first; e < elements.size(); ++e)
          if (std::ranges::max(elements[e]) >= first_moved)
            for (Index& node : elements[e]) node = parts.renumbered[static_cast<std::size_t>(node)];
      } else {
        std::ranges::copy(changed.tree->tree().element_nodes(changed_elements.cells[first]),
                          elements.emplace_back().begin());
      }
    }
    parts.origins.push_back(std::move(changed_elements.origins));
    topology->cells.push_back(std::move(changed_elements.cells));
  });
  parts.families = std::move(element_changes).families();
  detail::share_volumes(before->mesh, parts.families);
  Transfer<dim> transfer(std::move(parts));
  for (auto const& [name, facets] : before->mesh.boundaries)
    mesh.boundaries.emplace(name, transfer.carry_facets(facets));
  mesh.slaves = changed.tree->slaves();
  detail::for_each_type_of(mesh, [&]<Element E>(E, std::size_t type) {
    topology->element_values.push_back(
        detail::carried_values<E>(*before, mesh, transfer, values, type));
  });
  topology->interpolation = Interpolation(mesh.slaves);
  topology->tree = changed.tree;
  auto const split_before = [&](Index c) { return old.tree->cell(c).is_split(); };
  auto const merged =
      static_cast<std::size_t>(std::ranges::count_if(changes.families, split_before));
  return TopologyPlan<M>{before,
                         std::move(topology),
                         std::move(transfer),
                         {.refined = changed.refinement.parents.size(),
                          .coarsened = changes.families.size() - merged,
                          .raised = changed.raised,
                          .lowered = changes.lower.size(),
                          .split = changed.split.size(),
                          .merged = merged}};
}

}  // namespace pliant
