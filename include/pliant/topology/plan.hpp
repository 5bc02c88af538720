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
    if (!lists.empty()) detail::check_lists<M>(verb, lists);
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
  auto changes = detail::changes_of(old, marked);
  if (changes.none()) return std::nullopt;
  auto lists = kept.facets;
  for (auto const& [name, facets] : before->boundaries()) lists.push_back(facets.get());
  KnownFacets<dim> const known(std::move(lists));
  auto changed = detail::change_cells(*old.tree, changes, limits, known);
  while (detail::take_back(*old.tree, changes, changed, kept))
    changed = detail::change_cells(*old.tree, changes, limits, known);
  if (changes.families.empty() && changed.refinement.parents.empty() && changed.converted.empty() &&
      changed.split.empty())
    return std::nullopt;

  auto new_nodes = std::move(changed.refinement.new_nodes);
  new_nodes.append(changed.added);
  auto converted = changed.converted;
  for (Index& c : converted) c = changed.renumbered(c);
  std::ranges::move(changed.tree->whole_facets(converted),
                    std::back_inserter(changed.refinement.facets));
  typename Transfer<dim>::Parts parts{
      .old_nodes = before->nodes(),
      .renumbered = std::move(changed.coarsening.renumbered.nodes),
      .new_nodes = std::move(new_nodes),
      .gone = std::move(changed.coarsening.gone),
      .old_elements = before->counts(),
      .divided = std::move(changed.refinement.facets),
      .merged = std::move(changed.coarsening.facets),
  };
  detail::ElementChanges<M> element_changes(*old.cells, *old.tree, changes.families, changed);
  std::vector<CellSet> cells;
  detail::for_each_type_of<M>([&]<Element E>(E, std::size_t type) {
    auto changed_elements = element_changes.template of<E>(type);
    parts.origins.push_back(std::move(changed_elements.origins));
    cells.push_back(std::move(changed_elements.cells));
  });
  parts.families = std::move(element_changes).families();
  detail::share_volumes(*before, parts.families);
  Transfer<dim> transfer(std::move(parts));
  auto topology = std::make_shared<Topology<M>>(changed.tree, std::move(cells));
  topology->first_renumbered_cell = changed.first_renumbered();
  topology->set_boundaries(before->boundaries(), [&](auto const& facets) {
    auto others = transfer.changed_facets(*facets);
    return others ? std::make_shared<std::vector<Facet<dim>> const>(std::move(*others)) : facets;
  });
  detail::for_each_type_of<M>([&]<Element E>(E, std::size_t type) {
    topology->element_values.push_back(
        detail::carried_values<E>(*before, *topology, transfer, values, type));
  });
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
