#pragma once

#include <optional>

#include <pliant/adaptation/family_momentum.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/change_topology.hpp>
#include <pliant/element/linear.hpp>

namespace pliant {

namespace detail {

template <class E>
inline constexpr bool can_be_split = std::same_as<E, Tri3> || std::same_as<E, Quad4>;
template <Element... Es>
inline constexpr bool can_be_split<Mesh<Es...>> = (can_be_split<Es> && ...);

template <class E, Element... Es>
std::vector<Connectivity<E>> elements_or_none(Mesh<Es...> const& mesh) {
  if constexpr ((std::same_as<E, Es> || ...))
    return mesh.template elements<E>();
  else
    return {};
}

/// The refinement tree of a plane body: the one it has, or a new one.
template <class M>
std::shared_ptr<Hierarchy const> tree_of(Topology<M> const& topology) {
  if (topology.tree) return topology.tree;
  auto const& mesh = topology.mesh;
  if (!mesh.slaves.empty())
    throw Error("refine: the mesh came with ", mesh.slaves.size(),
                " hanging nodes, of which it is not known what was refined; give the coarse mesh, "
                "and refine the body");
  return std::make_shared<Hierarchy>(mesh.nodes, elements_or_none<Tri3>(mesh),
                                     elements_or_none<Quad4>(mesh));
}

template <Element E>
inline constexpr int sides_of = static_cast<int>(E::cell::sides().size());

/// The leaves of a tree that are elements of a type, in the order of the mesh's list.
template <Element E>
std::vector<Index> leaves_of(Hierarchy const& tree) {
  std::vector<Index> cells;
  for (Index c : tree.leaves())
    if (tree.cell(c).sides == sides_of<E>) cells.push_back(c);
  return cells;
}

/// How often each element of a type was refined, by the user's number.
template <Element E, class Parts>
std::vector<int> levels_of(Parts const& parts) {
  auto const& topology = *parts.state.topology;
  if (!topology.tree) return std::vector<int>(topology.mesh.template elements<E>().size(), 0);
  std::vector<int> levels;
  for (Index c : leaves_of<E>(*topology.tree)) levels.push_back(topology.tree->cell(c).level);
  return levels;
}

/// The cells of marked elements, which are given by the user's numbers for each element type.
template <Element... Es>
std::vector<Index> cells_of(Mesh<Es...> const&, Hierarchy const& tree,
                            std::vector<std::vector<Index>> const& marked) {
  std::vector<Index> cells;
  auto list = marked.begin();
  auto const add = [&]<Element E>(E) {
    auto const leaves = leaves_of<E>(tree);
    for (Index e : *list++) {
      if (e < 0 || e >= static_cast<Index>(leaves.size()))
        throw Error("refine: there is no ", E::name(), " element ", e, "; they are numbered 0 to ",
                    leaves.size() - 1);
      cells.push_back(leaves[static_cast<std::size_t>(e)]);
    }
  };
  (add(Es{}), ...);
  return cells;
}

/// Where the elements of a type come from, in the order of the new mesh's list.
template <Element E>
std::vector<Transfer<2>::Origin> origins_of(Hierarchy const& before, Hierarchy const& after) {
  std::vector<Index> element_of(before.cells().size(), -1);  // by cell
  auto const old_leaves = leaves_of<E>(before);
  for (std::size_t e = 0; e < old_leaves.size(); ++e)
    element_of[static_cast<std::size_t>(old_leaves[e])] = static_cast<Index>(e);
  std::vector<Transfer<2>::Origin> origins;
  for (Index c : leaves_of<E>(after)) {
    if (static_cast<std::size_t>(c) < element_of.size()) {
      origins.push_back({element_of[static_cast<std::size_t>(c)], -1});
    } else {
      Index const parent = after.cell(c).parent;
      origins.push_back({element_of[static_cast<std::size_t>(parent)],
                         static_cast<int>(c - after.cell(parent).first_child)});
    }
  }
  return origins;
}

/// The new nodes of a refinement, as means of their parents.
inline std::vector<Transfer<2>::NewNode> interpolated_nodes(std::vector<NewNode> const& nodes) {
  std::vector<Transfer<2>::NewNode> list;
  for (NewNode const& n : nodes) {
    list.push_back({n.node, {}});
    for (int k = 0; k < n.count; ++k)
      list.back().parents.emplace_back(n.parents[static_cast<std::size_t>(k)], 1.0 / n.count);
  }
  return list;
}

}  // namespace detail

/// What a refinement did.
struct RefinementReport {
  std::size_t refined = 0;  // elements split, those included that keep neighbours within one level
  std::size_t new_nodes = 0;
};

/// A refinement that is ready to be made; nothing has changed yet.
template <class M>
struct RefinementPlan {
  std::shared_ptr<Topology<M> const> before, after;
  Transfer<2> transfer;
  std::vector<Index> parents;  // cells of after.tree that were split, coarser ones first
};

/// Plans the refinement of marked elements: see refine. Empty where none is split. Throws Error where an
/// element is unknown or the body's limits would be exceeded.
template <class Parts>
auto plan_refinement(Parts const& parts, std::vector<std::vector<Index>> const& marked,
                     int max_level = 30)
    -> std::optional<RefinementPlan<typename Parts::mesh_type>> {
  using M = typename Parts::mesh_type;
  constexpr std::size_t types = std::tuple_size_v<decltype(M::tables)>;
  if (marked.size() != types)
    throw Error("refine: got lists of marked elements for ", marked.size(),
                " element types, but the mesh has ", types,
                "; give one list per type, empty where none is refined");
  if (std::ranges::all_of(marked, &std::vector<Index>::empty)) return std::nullopt;

  auto const& old = *parts.state.topology;
  auto const before = detail::tree_of(old);
  auto const tree = std::make_shared<Hierarchy>(*before);
  Refinement const done = tree->refine(detail::cells_of(old.mesh, *before, marked),
                                       {parts.limits.nodes, parts.limits.elements, max_level});
  if (done.parents.empty()) return std::nullopt;

  auto const origins = [&]<Element... Es>(Mesh<Es...> const&) {
    return std::vector<std::vector<Transfer<2>::Origin>>{detail::origins_of<Es>(*before, *tree)...};
  }(old.mesh);
  std::vector<std::size_t> old_elements;
  for (std::size_t type = 0; type < types; ++type)
    old_elements.push_back(detail::element_count(old.mesh, type));
  Transfer<2> transfer(static_cast<Index>(old.mesh.nodes.size()),
                       detail::interpolated_nodes(done.new_nodes), old_elements, origins);

  auto topology = std::make_shared<Topology<M>>();
  M& mesh = topology->mesh;
  mesh.nodes = tree->points();
  [&]<Element... Es>(Mesh<Es...>&) {
    auto const fill = [&]<Element E>(E) {
      for (Index c : detail::leaves_of<E>(*tree))
        std::copy_n(tree->cell(c).nodes.begin(), std::size_t{E::nodes},
                    mesh.template elements<E>().emplace_back().begin());
    };
    (fill(Es{}), ...);
  }(mesh);
  for (auto const& [name, facets] : old.mesh.boundaries)
    mesh.boundaries.emplace(name, transfer.carry_facets(facets));
  mesh.slaves = tree->slaves();
  for (std::size_t type = 0; type < types; ++type) {
    auto const& values = old.element_values[type];
    std::size_t const count = old_elements[type];
    topology->element_values.push_back(
        transfer.carry_elements(values, type, count > 0 ? values.size() / count : 0));
  }
  topology->interpolation = Interpolation(mesh.slaves);
  topology->tree = tree;
  return RefinementPlan<M>{parts.state.topology, std::move(topology), std::move(transfer),
                           done.parents};
}

/// Makes a planned refinement; listeners wait for tell_listeners. Throws Error, with the body as it was, where
/// fields are not finite, a force term cannot be made anew or memory runs out.
template <class Parts>
RefinementReport commit(Parts& parts, RefinementPlan<typename Parts::mesh_type> const& plan) {
  wake_all(parts);
  double const strain = energy_at(std::as_const(parts), std::as_const(parts).u());
  double const kinetic = kinetic_energy_of(parts);
  auto const before = present_energy(parts);
  auto const give_back = [&](auto const& layout, auto const& held, auto& v) {
    return detail::give_momentum_back(*plan.after->tree, plan.parents, parts.material.density,
                                      layout, *plan.after, held, v);
  };
  auto [next, taken] = change_topology(parts, plan.after, plan.transfer, give_back);
  auto const change = [](double from, double to) { return detail::zero_if_not_finite(to - from); };
  LedgerEntry<2> const entry{
      next.state.time,
      "refine",
      static_cast<double>(plan.parents.size()),
      change(strain, energy_at(std::as_const(next), std::as_const(next).u())),
      change(kinetic, kinetic_energy_of(next)),
      taken};
  next.state.record.refinements.push_back(entry);
  // The energy that an integrator keeps may have changed by more, with masses and forces.
  double const added = watched_change(next, before);
  if (next.watched_energy && next.state.integrator.active)
    next.state.energy_by_hand += added - entry.strain_energy - entry.kinetic_energy;
  put_in_force(parts, std::move(next));
  return {plan.parents.size(), plan.transfer.new_nodes().size()};
}

/// Tells a body's listeners of a refinement that was made. What one throws is the caller's: the body is refined,
/// and listeners after it are not told.
template <class Parts>
void tell_listeners(Parts const& parts, RefinementPlan<typename Parts::mesh_type> const& plan) {
  for (auto const& listener : parts.listeners) listener({*plan.before, *plan.after, plan.transfer});
}

/// Splits elements of a plane body into four. `marked` has, for each element type in the order of the
/// mesh, the elements to split by the user's number. Neighbours differ by one level at most; hanging
/// nodes become slaves. New nodes take displacement and velocity from the parent's shape functions,
/// nodes that stay keep theirs and their number; each family then gets back the momentum that
/// lumping its mass anew took, so that linear momentum is kept to rounding and rigid translation
/// exactly. Children inherit groups, conditions on facets, pressures and named boundaries;
/// conditions and loads on nodes stay with their nodes. What it did to the energy is in ledger(body).
/// Throws Error, with the body as it was, where an element is unknown, the body's limits would be
/// exceeded, or a user's force term cannot be made anew. Listeners are told last: the body is refined whatever
/// they throw.
template <DeformableBody TheBody>
RefinementReport refine(TheBody& body, std::vector<std::vector<Index>> const& marked,
                        int max_level = 30) {
  static_assert(detail::can_be_split<typename TheBody::mesh_type>,
                "refinement is available for plane meshes of Tri3 and Quad4");
  auto const plan = plan_refinement(body.parts(), marked, max_level);
  if (!plan) return {};
  auto const report = commit(body.parts(), *plan);
  tell_listeners(body.parts(), *plan);
  return report;
}

/// The largest mesh that refinements of a body may make.
template <DeformableBody TheBody>
void set_mesh_limits(TheBody& body, MeshLimits limits) {
  body.parts().limits = limits;
}

}  // namespace pliant
