#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include <pliant/topology/hierarchy.hpp>
#include <pliant/topology/tree_queries.hpp>

// Changes of the cells of a tree, and what must stay as it is.
namespace pliant {

/// What must stay where elements are merged: nodes, and facets that must not be merged in part.
template <int Dim>
struct KeptParts {
  std::vector<Index> nodes;
  std::vector<std::vector<Facet<Dim>> const*> facets;
};

namespace detail {

/// What is to become of the cells of a tree, by their present numbers.
struct CellChanges {
  std::vector<Index> families, refine, lower;  // families: parents, refined or split
  std::vector<CellConversion> raise;
  std::vector<CellSplit> split;

  bool none() const {
    return families.empty() && refine.empty() && lower.empty() && raise.empty() && split.empty();
  }
};

/// A change of the cells of a tree: families are merged and degrees lowered before cells are refined; then degrees are raised
/// and cells split.
template <int Dim>
struct ChangedCells {
  std::shared_ptr<Hierarchy<Dim>> tree;
  Coarsening<Dim> coarsening;
  Refinement<Dim> refinement;
  WeightedNodes added;           // by raising and splitting
  std::vector<Index> converted;  // cells of another degree, by their old numbers, ascending
  std::vector<Index> split;      // by their new numbers
  std::size_t raised = 0;

  /// Cells before this one keep their numbers.
  Index first_renumbered() const { return coarsening.renumbered.cells.first(); }
  /// The new number of a cell.
  Index renumbered(Index c) const { return coarsening.renumbered.cells[c]; }
};

/// Makes changes of cells. Those that are refined, or merged, are not raised, and neither they nor raised ones are split.
template <int Dim>
ChangedCells<Dim> change_cells(Hierarchy<Dim> const& before, CellChanges const& changes,
                               RefinementLimits const& limits, KnownFacets<Dim> const& known) {
  ChangedCells<Dim> changed{
      std::make_shared<Hierarchy<Dim>>(before), {}, {}, {}, changes.lower, {}, 0};
  auto& tree = *changed.tree;
  changed.coarsening = tree.merge(changes.families, changes.lower, known);
  auto refine = changes.refine;
  for (Index& c : refine) c = changed.renumbered(c);
  changed.refinement =
      tree.refine(refine, limits, known.renumbered(changed.coarsening.renumbered.nodes));
  std::vector<CellConversion> raise;
  for (auto const& [old, has] : changes.raise) {
    Index const c = changed.renumbered(old);
    if (c < 0 || !tree.is_leaf(c)) continue;
    raise.push_back({c, has});
    changed.converted.push_back(old);
  }
  changed.added = tree.raise(raise, limits).new_nodes;
  changed.raised = raise.size();
  std::ranges::sort(changed.converted);
  std::vector<CellSplit> split;
  auto const can_be_split = [&](Index c) {
    return c >= 0 && tree.is_leaf(c) && tree.cell(c).has == CellNodes::corners;
  };
  for (auto const& [old, division] : changes.split) {
    Index const c = changed.renumbered(old);
    if (!can_be_split(c)) continue;
    if (tree.cell(c).kind == CellKind::pyramid) {  // with the one on the other side of its base
      Index const other = TreeQueries(tree.tree()).across_base(c);
      if (!can_be_split(other) || tree.cell(other).kind != CellKind::pyramid) continue;
    }
    split.push_back({c, division});
    changed.split.push_back(c);
  }
  changed.added.append(tree.split(split, limits).new_nodes);
  return changed;
}

/// The nodes that go with a change and must stay, ascending.
template <int Dim>
std::vector<Index> lost_nodes(ChangedCells<Dim> const& changed, KeptParts<Dim> const& kept) {
  std::vector<Index> lost, named = kept.nodes;
  std::ranges::sort(named);
  for (NewNode const& gone : changed.coarsening.gone)
    if (std::ranges::binary_search(named, gone.node)) lost.push_back(gone.node);
  return lost;
}

/// Those of which a part has no corners but such of kept facets: most merged facets have none, and need no look.
template <int Dim>
std::vector<DividedFacet<Dim>> with_kept_nodes(std::vector<DividedFacet<Dim>> const& merged,
                                               std::size_t nodes, KeptParts<Dim> const& kept) {
  std::vector<bool> is_kept(nodes, false);
  for (auto const* list : kept.facets)
    for (auto const& facet : *list)
      for (Index const node : facet) is_kept[static_cast<std::size_t>(node)] = true;
  std::vector<DividedFacet<Dim>> found;
  std::ranges::copy_if(merged, std::back_inserter(found), [&](DividedFacet<Dim> const& own) {
    return std::ranges::any_of(own.parts, [&](Facet<Dim> const& part) {
      return std::all_of(part.begin(), part.begin() + part.corners(),
                         [&](Index node) { return is_kept[static_cast<std::size_t>(node)]; });
    });
  });
  return found;
}

/// Of the families that a change merges, those that have to stay: which a refinement beside them would divide again, that
/// lose a node that must stay, or of whose facets some list names a part of the whole only.
template <int Dim>
std::vector<Index> families_to_keep(Hierarchy<Dim> const& before,
                                    std::vector<Index> const& families,
                                    ChangedCells<Dim> const& changed, KeptParts<Dim> const& kept) {
  if (families.empty()) return {};
  auto const lost = lost_nodes(changed, kept);
  std::vector<Facet<Dim>> cut;
  if (!kept.facets.empty()) {
    Transfer<Dim> const facets(
        {.merged = with_kept_nodes(changed.coarsening.facets, before.points().size(), kept)});
    for (auto const* list : kept.facets) {
      auto const own = facets.cut_facets(*list);
      cut.insert(cut.end(), own.begin(), own.end());
    }
  }
  auto split_again = changed.refinement.parents;
  std::ranges::sort(split_again);

  auto const has_to_stay = [&](Index parent) {
    auto const& cell = before.cell(parent);
    for (Index c = cell.first_child;
         !(lost.empty() && cut.empty()) && c < cell.first_child + cell.divided().children; ++c) {
      auto const nodes = before.tree().nodes_of(c);
      auto const has = [&](Index node) { return std::ranges::find(nodes, node) != nodes.end(); };
      for (Index node : nodes)
        if (std::ranges::binary_search(lost, node)) return true;
      for (auto const& facet : cut)
        if (std::ranges::all_of(facet, has)) return true;
    }
    return std::ranges::binary_search(split_again, changed.renumbered(parent));
  };
  std::vector<Index> keep;
  std::ranges::copy_if(families, std::back_inserter(keep), has_to_stay);
  // Two pyramids that share a base are split alike.
  for (std::size_t i = 0, count = keep.size(); i < count; ++i)
    if (auto const& cell = before.cell(keep[i]); cell.is_split() && cell.kind == CellKind::pyramid)
      keep.push_back(TreeQueries(before.tree()).across_base(keep[i]));
  std::ranges::sort(keep);
  return keep;
}

/// Of the cells that a change lowers, those that have to keep their degree: which are refined beside others, or have a node
/// that must stay. Ascending.
template <int Dim>
std::vector<Index> lowered_to_keep(Hierarchy<Dim> const& before, std::vector<Index> const& lowered,
                                   ChangedCells<Dim> const& changed, KeptParts<Dim> const& kept) {
  if (lowered.empty()) return {};
  auto const lost = lost_nodes(changed, kept);
  auto const has_to_stay = [&](Index c) {
    if (!changed.tree->is_leaf(changed.renumbered(c))) return true;
    return !lost.empty() && std::ranges::any_of(before.tree().nodes_of(c), [&](Index node) {
      return std::ranges::binary_search(lost, node);
    });
  };
  std::vector<Index> keep;
  std::ranges::copy_if(lowered, std::back_inserter(keep), has_to_stay);
  std::ranges::sort(keep);
  return keep;
}

/// Takes back what has to stay as it is; whether something does.
template <int Dim>
bool take_back(Hierarchy<Dim> const& before, CellChanges& changes, ChangedCells<Dim> const& changed,
               KeptParts<Dim> const& kept) {
  auto const keep = families_to_keep(before, changes.families, changed, kept);
  std::erase_if(changes.families, [&](Index c) { return std::ranges::binary_search(keep, c); });
  auto const stays = lowered_to_keep(before, changes.lower, changed, kept);
  std::erase_if(changes.lower, [&](Index c) { return std::ranges::binary_search(stays, c); });
  return !keep.empty() || !stays.empty();
}

}  // namespace detail

}  // namespace pliant
