#pragma once

#include <optional>

#include <pliant/adaptation/family_momentum.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/change_topology.hpp>
#include <pliant/topology/plan.hpp>

namespace pliant {

namespace detail {

/// How often each element of a type was refined, by the user's number.
template <Element E, class Parts>
std::vector<int> levels_of(Parts const& parts) {
  auto const& topology = *parts.state.topology;
  if (!topology.tree) return std::vector<int>(topology.mesh.template elements<E>().size(), 0);
  std::vector<int> levels;
  for (Index c : topology.cells[Parts::layout_type::template type_of<E>])
    levels.push_back(topology.tree->cell(c).level);
  return levels;
}

/// What a body's conditions need where elements are merged.
template <class Parts>
KeptParts<Parts::dim> kept_parts(Parts const& parts) {
  KeptParts<Parts::dim> kept;
  auto const& prescribed = *parts.state.prescribed;
  for (auto const& condition : prescribed.conditions) {
    if (condition.facets.empty())
      kept.nodes.insert(kept.nodes.end(), condition.nodes.begin(), condition.nodes.end());
    else
      kept.facets.push_back(&condition.facets);
  }
  for (auto const& pressure : prescribed.pressures) kept.facets.push_back(&pressure.facets);
  return kept;
}

}  // namespace detail

/// What refinement did.
struct RefinementReport {
  std::size_t refined = 0;  // elements split, those included that keep neighbours within one level
  std::size_t new_nodes = 0;
};

/// What coarsening did.
struct CoarseningReport {
  std::size_t merged = 0;  // elements that took the place of their children
  std::size_t gone_nodes = 0;
};

/// Plans a change of a body's mesh: see refine and coarsen. Empty where nothing changes. Throws Error where an
/// element is unknown or the body's limits would be exceeded.
template <class Parts>
auto plan_change(Parts const& parts, MarkedElements const& marked, int max_level = 30) {
  return plan_change(parts.state.topology, marked,
                     {parts.limits.nodes, parts.limits.elements, max_level},
                     detail::kept_parts(parts));
}

/// Makes a planned change; listeners wait for tell_listeners. Throws Error, with the body as it was, where
/// fields are not finite, a force term cannot be made anew or memory runs out.
template <class Parts>
void commit(Parts& parts, TopologyPlan<typename Parts::mesh_type> const& plan) {
  constexpr int dim = Parts::dim;
  wake_all(parts);
  auto const energy_now = [](Parts& p) {
    return p.watched_energy ? p.watched_energy(p) : WatchedEnergy{energies_of(p), 0};
  };
  auto const before = energy_now(parts);
  auto const give_back = [&](auto const& layout, auto const& held, auto const& v_before, auto& v) {
    return detail::give_momentum_back(plan, parts.material.density, layout, held, v_before, v);
  };
  auto [next, taken] = change_topology(parts, plan.after, plan.transfer, give_back);
  auto const after = energy_now(next);
  auto const change = [](double from, double to) { return detail::zero_if_not_finite(to - from); };
  LedgerEntry<dim> const entry{next.state.time,
                               plan.merged == 0    ? "refine"
                               : plan.refined == 0 ? "coarsen"
                                                   : "refine and coarsen",
                               static_cast<double>(plan.refined + plan.merged),
                               change(before.energies.strain, after.energies.strain),
                               change(before.energies.kinetic, after.energies.kinetic),
                               taken};
  next.state.record.refinements.push_back(entry);
  // The energy that an integrator keeps may have changed by more, with masses and forces.
  double const added = next.watched_energy ? watched_change(next, before, after) : 0;
  if (next.watched_energy && next.state.integrator.active)
    next.state.energy_by_hand += added - entry.strain_energy - entry.kinetic_energy;
  put_in_force(parts, std::move(next));
}

/// Tells a body's listeners of a change that was made. What one throws is the caller's: the mesh is changed,
/// and listeners after it are not told.
template <class Parts>
void tell_listeners(Parts const& parts, TopologyPlan<typename Parts::mesh_type> const& plan) {
  for (auto const& listener : parts.listeners) listener({*plan.before, *plan.after, plan.transfer});
}

/// Divides elements of a body: triangles and quadrilaterals into four, tetrahedra, hexahedra and wedges into eight
/// (see RefinementPattern). `marked` has, for each element type in the order of the
/// mesh, the elements to split by the user's number. Neighbours differ by one level at most, across edges and sides;
/// hanging nodes become slaves. New nodes take displacement and velocity from the parent's shape functions,
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
  static_assert(detail::can_be_refined<typename TheBody::mesh_type>,
                "refinement is available for meshes of the catalogue's elements, pyramids aside");
  detail::check_lists(body.mesh(), "refine", marked);
  auto const plan = plan_change(body.parts(), {.refine = marked, .coarsen = {}}, max_level);
  if (!plan) return {};
  commit(body.parts(), *plan);
  tell_listeners(body.parts(), *plan);
  return {plan->refined, plan->transfer.new_nodes().size()};
}

/// Undoes refinement: where all children of an element are marked (as for refine), and none is refined itself,
/// the element takes their place. A family stays where it would differ from a neighbour by two levels, where a node
/// would go that a condition on nodes names, or where of its facets not all are under a condition or pressure that
/// some are under. Nodes that stay keep displacement, velocity and order, and so their number if they are of the
/// initial mesh; nodes that go hand their loads to those they lay between, and each family keeps its momentum. Merged
/// elements are in the group that most of their children were in (the first of equals), have the mean of their values
/// by volume, and the internal variables of the nearest points. Errors as of refine.
template <DeformableBody TheBody>
CoarseningReport coarsen(TheBody& body, std::vector<std::vector<Index>> const& marked) {
  static_assert(detail::can_be_refined<typename TheBody::mesh_type>,
                "coarsening is available for meshes of the catalogue's elements, pyramids aside");
  detail::check_lists(body.mesh(), "coarsen", marked);
  auto const plan = plan_change(body.parts(), {.refine = {}, .coarsen = marked});
  if (!plan) return {};
  commit(body.parts(), *plan);
  tell_listeners(body.parts(), *plan);
  return {plan->merged, plan->transfer.gone().size()};
}

/// How often each element of a type was refined, by the user's number.
template <Element E, DeformableBody TheBody>
std::vector<int> refinement_levels(TheBody const& body) {
  return detail::levels_of<E>(body.parts());
}

/// The largest mesh that refinements of a body may make.
template <DeformableBody TheBody>
void set_mesh_limits(TheBody& body, MeshLimits limits) {
  body.parts().limits = limits;
}

}  // namespace pliant
