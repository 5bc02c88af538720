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

/// The refinement tree of a topology, and for each type the cells that its elements are: those that it has, or new ones.
template <class M>
struct RefinementTree {
  std::shared_ptr<Hierarchy<M::dim> const> tree;
  std::vector<std::vector<Index>> cells;
};
template <class M>
RefinementTree<M> tree_of(Topology<M> const& topology) {
  if (topology.tree) return {topology.tree, topology.cells};
  auto const& mesh = topology.mesh;
  if (!mesh.slaves.empty())
    throw Error("refine: the mesh came with ", mesh.slaves.size(),
                " hanging nodes, of which it is not known what was refined; give the coarse mesh, "
                "and refine the body");
  RefinementTree<M> made{std::make_shared<Hierarchy<M::dim>>(mesh), {}};
  Index next = 0;
  for (std::size_t count : element_counts(mesh)) {
    auto& cells = made.cells.emplace_back(count);
    for (Index& c : cells) c = next++;
  }
  return made;
}

/// The cells of marked elements, which are given by the user's numbers for each element type.
template <class M>
std::vector<Index> cells_of(M const& mesh, std::vector<std::vector<Index>> const& cells,
                            char const* verb, std::vector<std::vector<Index>> const& marked) {
  std::vector<Index> found;
  for_each_type_of(mesh, [&]<Element E>(E, std::size_t type) {
    if (marked.empty()) return;
    for (Index e : marked[type]) {
      if (e < 0 || e >= static_cast<Index>(cells[type].size()))
        throw Error(verb, ": there is no ", E::name(), " element ", e, "; they are numbered 0 to ",
                    cells[type].size() - 1);
      found.push_back(cells[type][static_cast<std::size_t>(e)]);
    }
  });
  return found;
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
  if (families.empty()) return {};
  std::vector<Index> lost;  // nodes that go and must stay, ascending
  std::vector<Index> named = kept.nodes;
  std::ranges::sort(named);
  for (NewNode const& gone : changed.coarsening.gone)
    if (std::ranges::binary_search(named, gone.node)) lost.push_back(gone.node);
  std::vector<Facet<Dim>> cut;
  if (!kept.facets.empty()) {
    Transfer<Dim> const facets({.merged = changed.coarsening.facets});
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
         !(lost.empty() && cut.empty()) && c < cell.first_child + cell.pattern().children; ++c) {
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
  return keep;
}

/// The elements of a type after a change.
template <int Dim>
struct ChangedElements {
  std::vector<Index> cells;  // of the tree, ascending
  std::vector<typename Transfer<Dim>::Origin> origins;
};

/// What becomes of the elements of a type that are the cells `old_cells` of a tree. Appends the families that are merged or
/// divided.
template <Element E>
ChangedElements<E::dim> change_elements(std::vector<Index> const& old_cells,
                                        Hierarchy<E::dim> const& before,
                                        std::vector<Index> const& merged,
                                        ChangedCells<E::dim> const& changed, std::size_t type,
                                        std::vector<typename Transfer<E::dim>::Family>& families) {
  using Origin = typename Transfer<E::dim>::Origin;
  auto const& after = *changed.tree;
  auto const old_element = [&](Index c) {
    return static_cast<Index>(std::ranges::lower_bound(old_cells, c) - old_cells.begin());
  };
  ChangedElements<E::dim> list;
  list.cells.reserve(old_cells.size());
  list.origins.reserve(old_cells.size());
  auto const add = [&](Index c, Origin const& origin) {
    list.cells.push_back(c);
    list.origins.push_back(origin);
  };
  auto const add_family = [&](TreeCell const& parent) -> auto& {
    auto& family = families.emplace_back();
    family.type = type;
    family.mirrored = parent.mirrored;
    return family;
  };
  auto next_merged = merged.begin();
  auto const add_merged_before = [&](Index old) {
    for (; next_merged != merged.end() && *next_merged < old; ++next_merged) {
      auto const& cell = before.cell(*next_merged);
      if (!is_cell_of<E>(cell)) continue;
      auto& family = add_family(cell);
      family.after = {static_cast<Index>(list.cells.size())};
      for (Index k = 0; k < cell.pattern().children; ++k)
        family.before.push_back(old_element(cell.first_child + k));
      add(changed.renumbered(*next_merged),
          {family.before[0], Origin::merged, static_cast<Index>(families.size()) - 1});
    }
  };

  // Numbers of cells stay in order, and those of new ones follow.
  auto divided = changed.refinement.parents;
  std::ranges::sort(divided);
  auto next_divided = divided.begin();
  std::vector<Index> divided_elements;
  for (std::size_t e = 0; e < old_cells.size(); ++e) {
    add_merged_before(old_cells[e]);
    Index const c = changed.renumbered(old_cells[e]);
    if (c < 0) continue;
    while (next_divided != divided.end() && *next_divided < c) ++next_divided;
    if (next_divided == divided.end() || *next_divided != c)
      add(c, {static_cast<Index>(e), Origin::same});
    else
      divided_elements.push_back(static_cast<Index>(e));
  }
  add_merged_before(static_cast<Index>(before.cells().size()));
  std::vector<Index> own_divided;
  std::ranges::copy_if(divided, std::back_inserter(own_divided),
                       [&](Index c) { return is_cell_of<E>(after.cell(c)); });
  for (Index const parent : changed.refinement.parents) {
    auto const& cell = after.cell(parent);
    if (!is_cell_of<E>(cell)) continue;
    auto const place = std::ranges::lower_bound(own_divided, parent) - own_divided.begin();
    auto& family = add_family(cell);
    family.before = {divided_elements[static_cast<std::size_t>(place)]};
    for (int child = 0; child < cell.pattern().children; ++child) {
      family.after.push_back(static_cast<Index>(list.cells.size()));
      add(cell.first_child + child,
          {family.before[0], child, static_cast<Index>(families.size()) - 1});
    }
  }
  return list;
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
  auto const old = detail::tree_of(*before);
  auto const refine = detail::cells_of(before->mesh, old.cells, "refine", marked.refine);
  auto families =
      old.tree->families(detail::cells_of(before->mesh, old.cells, "coarsen", marked.coarsen));
  if (families.empty() && refine.empty()) return std::nullopt;
  auto changed = detail::change_cells(*old.tree, families, refine, limits);
  for (;;) {
    auto const keep = detail::families_to_keep(*old.tree, families, changed, kept);
    if (keep.empty()) break;
    std::erase_if(families, [&](Index c) { return std::ranges::binary_search(keep, c); });
    changed = detail::change_cells(*old.tree, families, refine, limits);
  }
  if (families.empty() && changed.refinement.parents.empty()) return std::nullopt;

  typename Transfer<dim>::Parts parts{
      .old_nodes = static_cast<Index>(before->mesh.nodes.size()),
      .renumbered = std::move(changed.coarsening.renumbered.nodes),
      .new_nodes = std::move(changed.refinement.new_nodes),
      .gone = std::move(changed.coarsening.gone),
      .old_elements = detail::element_counts(before->mesh),
      .divided = std::move(changed.refinement.facets),
      .merged = std::move(changed.coarsening.facets),
  };
  auto topology = std::make_shared<Topology<M>>();
  M& mesh = topology->mesh;
  mesh.nodes = changed.tree->points();
  detail::for_each_type_of(mesh, [&]<Element E>(E, std::size_t type) {
    auto changed_elements = detail::change_elements<E>(old.cells[type], *old.tree, families,
                                                       changed, type, parts.families);
    auto& elements = mesh.template elements<E>();
    elements.reserve(changed_elements.cells.size());
    for (std::size_t e = 0; e < changed_elements.cells.size(); ++e) {
      auto const& origin = changed_elements.origins[e];
      if (origin.child == Transfer<dim>::Origin::same) {
        elements.push_back(
            before->mesh.template elements<E>()[static_cast<std::size_t>(origin.element)]);
        for (Index& node : elements.back())
          if (!parts.renumbered.empty()) node = parts.renumbered[static_cast<std::size_t>(node)];
      } else {
        std::ranges::copy(changed.tree->tree().element_nodes(changed_elements.cells[e]),
                          elements.emplace_back().begin());
      }
    }
    parts.origins.push_back(std::move(changed_elements.origins));
    topology->cells.push_back(std::move(changed_elements.cells));
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
