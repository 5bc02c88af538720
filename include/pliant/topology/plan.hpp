#pragma once

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <pliant/constraint/interpolation.hpp>
#include <pliant/formulation/mass.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

// From marked elements to another topology and the transfer to it, without a body.
namespace pliant {

/// Elements to refine and to coarsen: for each element type in the order of the mesh, their numbers. A list of no
/// types marks none.
struct MarkedElements {
  std::vector<std::vector<Index>> refine, coarsen;

  bool none() const {
    auto const empty = [](auto const& list) { return list.empty(); };
    return std::ranges::all_of(refine, empty) && std::ranges::all_of(coarsen, empty);
  }
};

/// What must stay where elements are merged: nodes, and facets that must not be merged in part.
template <int Dim>
struct KeptParts {
  std::vector<Index> nodes;
  std::vector<std::vector<Facet<Dim>> const*> facets;
};

/// A change of topology that is ready to be made; nothing has changed yet.
template <class M>
struct TopologyPlan {
  std::shared_ptr<Topology<M> const> before, after;
  Transfer<M::dim> transfer;
  std::size_t refined = 0;  // elements split, those included that keep neighbours within one level
  std::size_t merged = 0;   // elements that took the place of their children
};

namespace detail {

template <class M>
inline constexpr bool can_be_refined = false;
template <Element... Es>
inline constexpr bool can_be_refined<Mesh<Es...>> = (Refinable<Es> && ...);

template <Element E>
bool is_cell_of(TreeCell const& cell) {
  return cell.kind == kind_of<typename E::cell> && cell.has == nodes_on_cell<E>;
}

/// The leaves of a tree that are elements of a type, in the order of the mesh's list.
template <Element E>
std::vector<Index> leaves_of(Hierarchy<E::dim> const& tree) {
  std::vector<Index> cells;
  auto const& all = tree.cells();
  for (Index c = 0; c < static_cast<Index>(all.size()); ++c)
    if (tree.is_leaf(c) && is_cell_of<E>(tree.cell(c))) cells.push_back(c);
  return cells;
}

/// Calls visit(E{}, place of E among the mesh's types) for each element type.
template <Element... Es, class Visit>
void for_each_type_of(Mesh<Es...> const&, Visit const& visit) {
  std::size_t type = 0;
  (visit(Es{}, type++), ...);
}

/// How many elements there are, by type.
template <Element... Es>
std::vector<std::size_t> element_counts(Mesh<Es...> const& mesh) {
  return {mesh.template elements<Es>().size()...};
}

/// The refinement tree of a topology: the one it has, or a new one.
template <class M>
std::shared_ptr<Hierarchy<M::dim> const> tree_of(Topology<M> const& topology) {
  if (topology.tree) return topology.tree;
  auto const& mesh = topology.mesh;
  if (!mesh.slaves.empty())
    throw Error("refine: the mesh came with ", mesh.slaves.size(),
                " hanging nodes, of which it is not known what was refined; give the coarse mesh, "
                "and refine the body");
  return std::make_shared<Hierarchy<M::dim>>(mesh);
}

/// The cells of marked elements, which are given by the user's numbers for each element type.
template <class M>
std::vector<Index> cells_of(M const& mesh, Hierarchy<M::dim> const& tree, char const* verb,
                            std::vector<std::vector<Index>> const& marked) {
  std::vector<Index> cells;
  for_each_type_of(mesh, [&]<Element E>(E, std::size_t type) {
    if (marked.empty() || marked[type].empty()) return;
    auto const leaves = leaves_of<E>(tree);
    for (Index e : marked[type]) {
      if (e < 0 || e >= static_cast<Index>(leaves.size()))
        throw Error(verb, ": there is no ", E::name(), " element ", e, "; they are numbered 0 to ",
                    leaves.size() - 1);
      cells.push_back(leaves[static_cast<std::size_t>(e)]);
    }
  });
  return cells;
}

/// A change of the cells of a tree, families merged before cells are refined.
template <int Dim>
struct ChangedCells {
  std::shared_ptr<Hierarchy<Dim>> tree;
  Coarsening<Dim> coarsening;
  Refinement<Dim> refinement;

  /// The new number of a cell.
  Index renumbered(Index c) const {
    auto const& cells = coarsening.renumbered.cells;
    return cells.empty() ? c : cells[static_cast<std::size_t>(c)];
  }
};

/// Merges families and refines cells, given by the numbers of `before`.
template <int Dim>
ChangedCells<Dim> change_cells(Hierarchy<Dim> const& before, std::vector<Index> const& families,
                               std::vector<Index> refine, RefinementLimits const& limits) {
  ChangedCells<Dim> changed{std::make_shared<Hierarchy<Dim>>(before), {}, {}};
  changed.coarsening = changed.tree->merge(families);
  for (Index& c : refine) c = changed.renumbered(c);
  changed.refinement = changed.tree->refine(refine, limits);
  return changed;
}

/// Of the families that a change merges, those that have to stay: which a refinement beside them would divide again, that
/// lose a node that must stay, or of whose facets some list names a part of the whole only.
template <int Dim>
std::vector<Index> families_to_keep(Hierarchy<Dim> const& before,
                                    std::vector<Index> const& families,
                                    ChangedCells<Dim> const& changed, KeptParts<Dim> const& kept) {
  std::vector<bool> lost(before.points().size(), false);  // nodes that go and must stay
  for (NewNode const& gone : changed.coarsening.gone)
    lost[static_cast<std::size_t>(gone.node)] = true;
  std::vector<bool> named(lost.size(), false);
  for (Index node : kept.nodes) named[static_cast<std::size_t>(node)] = true;
  for (std::size_t i = 0; i < lost.size(); ++i) lost[i] = lost[i] && named[i];
  std::vector<Facet<Dim>> cut;
  Transfer<Dim> const facets({.merged = changed.coarsening.facets});
  for (auto const* list : kept.facets) {
    auto const own = facets.cut_facets(*list);
    cut.insert(cut.end(), own.begin(), own.end());
  }

  auto const& split_again = changed.refinement.parents;
  auto const has_to_stay = [&](Index parent) {
    auto const& cell = before.cell(parent);
    for (Index c = cell.first_child; c < cell.first_child + cell.pattern().children; ++c) {
      auto const nodes = before.tree().nodes_of(c);
      auto const has = [&](Index node) { return std::ranges::find(nodes, node) != nodes.end(); };
      for (Index node : nodes)
        if (lost[static_cast<std::size_t>(node)]) return true;
      for (auto const& facet : cut)
        if (std::ranges::all_of(facet, has)) return true;
    }
    return std::ranges::find(split_again, changed.renumbered(parent)) != split_again.end();
  };
  std::vector<Index> keep;
  std::ranges::copy_if(families, std::back_inserter(keep), has_to_stay);
  return keep;
}

/// Where the elements of a type come from, in the order of the new mesh's list, and the families that were merged or
/// divided.
template <Element E, class Families>
auto origins_of(Hierarchy<E::dim> const& before, ChangedCells<E::dim> const& changed,
                std::size_t type, Families& families) {
  using Origin = typename Transfer<E::dim>::Origin;
  auto const& after = *changed.tree;
  std::vector<Index> old_element(before.cells().size(), -1), old_cell(after.cells().size(), -1);
  auto const old_leaves = leaves_of<E>(before);
  for (std::size_t e = 0; e < old_leaves.size(); ++e)
    old_element[static_cast<std::size_t>(old_leaves[e])] = static_cast<Index>(e);
  for (Index c = 0; c < static_cast<Index>(before.cells().size()); ++c)
    if (changed.renumbered(c) >= 0) old_cell[static_cast<std::size_t>(changed.renumbered(c))] = c;

  std::vector<Origin> origins;
  for (Index c : leaves_of<E>(after)) {
    auto const e = static_cast<Index>(origins.size());
    Index const old = old_cell[static_cast<std::size_t>(c)];
    if (old >= 0 && before.is_leaf(old)) {
      origins.push_back({old_element[static_cast<std::size_t>(old)], Origin::same});
    } else if (old >= 0) {
      auto const& cell = before.cell(old);
      auto& family = families.emplace_back();
      family.type = type;
      family.mirrored = cell.mirrored;
      family.after = {e};
      for (Index k = 0; k < cell.pattern().children; ++k)
        family.before.push_back(old_element[static_cast<std::size_t>(cell.first_child + k)]);
      origins.push_back(
          {family.before[0], Origin::merged, static_cast<Index>(families.size()) - 1});
    } else {
      Index const parent = after.cell(c).parent;
      auto const child = static_cast<int>(c - after.cell(parent).first_child);
      if (child == 0) {
        auto& family = families.emplace_back();
        family.type = type;
        family.mirrored = after.cell(parent).mirrored;
        family.before = {
            old_element[static_cast<std::size_t>(old_cell[static_cast<std::size_t>(parent)])]};
      }
      // Siblings stand side by side.
      auto& family = families.back();
      family.after.push_back(e);
      origins.push_back({family.before[0], child, static_cast<Index>(families.size()) - 1});
    }
  }
  return origins;
}

/// The shares of the merged elements in the volume of their family.
template <class M>
void share_volumes(M const& mesh, std::vector<typename Transfer<M::dim>::Family>& families) {
  for_each_type_of(mesh, [&]<Element E>(E, std::size_t type) {
    for (auto& family : families) {
      if (family.type != type) continue;
      double sum = 0;
      for (Index e : family.before) {
        auto const& nodes = mesh.template elements<E>()[static_cast<std::size_t>(e)];
        family.shares.push_back(volume<E, MassQuadrature<E>>(nodal(mesh, nodes)));
        sum += family.shares.back();
      }
      for (double& share : family.shares) share /= sum;
    }
  });
}

template <class M>
void check_lists(M const& mesh, char const* verb, std::vector<std::vector<Index>> const& marked) {
  std::size_t const types = element_counts(mesh).size();
  if (marked.size() != types)
    throw Error(verb, ": got lists of marked elements for ", marked.size(),
                " element types, but the mesh has ", types,
                "; give one list per type, empty where none is marked");
}

}  // namespace detail

/// Plans a change of a topology: marked elements are divided, and families of which all are marked merged. Neighbours
/// differ by one level at most: what is coarser beside an element to divide is divided too, and a family stays
/// where it would become too coarse, or where `kept` says so. Empty where nothing changes. Throws Error where an
/// element is unknown or a limit would be exceeded.
template <class M>
auto plan_change(std::shared_ptr<Topology<M> const> const& before, MarkedElements const& marked,
                 RefinementLimits const& limits, KeptParts<M::dim> const& kept)
    -> std::optional<TopologyPlan<M>> {
  constexpr int dim = M::dim;
  if (!marked.refine.empty()) detail::check_lists(before->mesh, "refine", marked.refine);
  if (!marked.coarsen.empty()) detail::check_lists(before->mesh, "coarsen", marked.coarsen);
  if (marked.none()) return std::nullopt;
  auto const old_tree = detail::tree_of(*before);
  auto const refine = detail::cells_of(before->mesh, *old_tree, "refine", marked.refine);
  auto families =
      old_tree->families(detail::cells_of(before->mesh, *old_tree, "coarsen", marked.coarsen));
  if (families.empty() && refine.empty()) return std::nullopt;
  auto changed = detail::change_cells(*old_tree, families, refine, limits);
  for (;;) {
    auto const keep = detail::families_to_keep(*old_tree, families, changed, kept);
    if (keep.empty()) break;
    std::erase_if(families, [&](Index c) { return std::ranges::binary_search(keep, c); });
    changed = detail::change_cells(*old_tree, families, refine, limits);
  }
  if (families.empty() && changed.refinement.parents.empty()) return std::nullopt;

  typename Transfer<dim>::Parts parts{
      .old_nodes = static_cast<Index>(before->mesh.nodes.size()),
      .renumbered = changed.coarsening.renumbered.nodes,
      .new_nodes = changed.refinement.new_nodes,
      .gone = changed.coarsening.gone,
      .old_elements = detail::element_counts(before->mesh),
      .divided = changed.refinement.facets,
      .merged = changed.coarsening.facets,
  };
  auto topology = std::make_shared<Topology<M>>();
  M& mesh = topology->mesh;
  mesh.nodes = changed.tree->points();
  detail::for_each_type_of(mesh, [&]<Element E>(E, std::size_t type) {
    parts.origins.push_back(detail::origins_of<E>(*old_tree, changed, type, parts.families));
    for (Index c : detail::leaves_of<E>(*changed.tree))
      std::ranges::copy(changed.tree->tree().element_nodes(c),
                        mesh.template elements<E>().emplace_back().begin());
  });
  detail::share_volumes(before->mesh, parts.families);
  Transfer<dim> transfer(std::move(parts));
  for (auto const& [name, facets] : before->mesh.boundaries)
    mesh.boundaries.emplace(name, transfer.carry_facets(facets));
  mesh.slaves = changed.tree->slaves();
  auto const counts = detail::element_counts(before->mesh);
  for (std::size_t type = 0; type < counts.size(); ++type) {
    auto const& values = before->element_values[type];
    topology->element_values.push_back(
        transfer.carry_elements(values, type, counts[type] > 0 ? values.size() / counts[type] : 0));
  }
  topology->interpolation = Interpolation(mesh.slaves);
  topology->tree = changed.tree;
  return TopologyPlan<M>{before, std::move(topology), std::move(transfer),
                         changed.refinement.parents.size(), families.size()};
}

}  // namespace pliant
