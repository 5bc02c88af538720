#pragma once

#include <optional>
#include <string>

#include <pliant/adaptation/family_momentum.hpp>
#include <pliant/adaptation/rule.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/change_topology.hpp>
#include <pliant/body/refine_on.hpp>
#include <pliant/topology/plan.hpp>

namespace pliant {

namespace detail {

/// How often each element of a type was refined, by the user's number.
template <Element E, class Parts>
std::vector<int> levels_of(Parts const& parts) {
  auto const& topology = *parts.state.topology;
  if (!topology.tree) return std::vector<int>(topology.mesh().template elements<E>().size(), 0);
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

/// What a change does, in words.
template <class M>
std::string actions_of(TopologyPlan<M> const& plan) {
  std::string words;
  auto const add = [&](std::size_t count, char const* word) {
    if (count > 0) words += (words.empty() ? "" : " and ") + std::string(word);
  };
  auto const& counts = plan.counts;
  add(counts.refined, "refine");
  add(counts.coarsened, "coarsen");
  add(counts.raised, "raise");
  add(counts.lowered, "lower");
  add(counts.split, "split");
  add(counts.merged, "merge");
  return words;
}

/// How many elements a change acts on.
template <class M>
std::size_t count_actions(TopologyPlan<M> const& plan) {
  auto const& counts = plan.counts;
  return counts.refined + counts.coarsened + counts.raised + counts.lowered + counts.split +
         counts.merged;
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

/// What raising degrees did.
struct RaisingReport {
  std::size_t raised = 0;
  std::size_t new_nodes = 0;
};

/// What lowering degrees did.
struct LoweringReport {
  std::size_t lowered = 0;
  std::size_t gone_nodes = 0;
};

/// What splitting did.
struct SplittingReport {
  std::size_t split = 0;
  std::size_t new_nodes = 0;
};

/// What merging did.
struct MergingReport {
  std::size_t merged = 0;  // elements that took the place of those into which they were split
  std::size_t gone_nodes = 0;
};

/// Plans a change of a body's mesh: see refine, coarsen, raise, lower, split and merge. Empty where nothing changes. Throws Error where an
/// element is unknown or the body's limits would be exceeded.
template <class Parts>
auto plan_change(Parts const& parts, MarkedElements const& marked, int max_level = 30) {
  HostThreads const threads(parts.backend, *parts.state.topology);
  return plan_change(parts.state.topology.shared(), marked,
                     {parts.limits.nodes, parts.limits.elements, max_level},
                     detail::kept_parts(parts), detail::element_values_of(parts));
}

namespace detail {

/// Puts a ChangedTopology, which change() gives, in force, and books what it does to energies. `actions`, `count`: in words, and
/// on how many elements it acts.
template <class Parts, class Change>
void commit_change(Parts& parts, std::string actions, std::size_t count, Change const& change) {
  constexpr int dim = Parts::dim;
  wake_all(parts);
  auto const energies_but_strain = [](Parts& p) {
    return Energies{0, kinetic_energy_of(p), p.watched_energy ? potential_energy_of(p) : 0};
  };
  auto const energy_now = [](Parts& p, Energies const& energies) {
    return p.watched_energy ? p.watched_energy(p, energies) : WatchedEnergy{energies, 0};
  };
  auto energies = energies_but_strain(parts);
  auto changed = change();
  auto& next = changed.parts;
  energies.strain = changed.strain_energy_before;
  auto const before = energy_now(parts, energies);
  energies = energies_but_strain(next);
  energies.strain = changed.strain_energy;
  auto const after = energy_now(next, energies);
  auto const added_to = [](double from, double to) { return zero_if_not_finite(to - from); };
  LedgerEntry<dim> const entry{next.state.time,
                               std::move(actions),
                               static_cast<double>(count),
                               added_to(before.energies.strain, after.energies.strain),
                               added_to(before.energies.kinetic, after.energies.kinetic),
                               changed.taken};
  next.state.record.refinements.push_back(entry);
  // The energy that an integrator keeps may have changed by more, with masses and forces.
  double const added = next.watched_energy ? watched_change(next, before, after) : 0;
  if (next.watched_energy && next.state.integrator.active)
    next.state.energy_by_hand += added - entry.strain_energy - entry.kinetic_energy;
  put_in_force(parts, std::move(next));
}

/// What became of a refinement in a backend's memory.
struct RefinedOn {
  std::size_t refined = 0, new_nodes = 0;
};
/// Refines elements of a body in its backend's memory, where that can be; else nothing. Errors as of refine; then what was kept
/// of the mesh there is made anew when it is needed.
template <class Parts>
std::optional<RefinedOn> refine_on_backend(Parts& parts,
                                           std::vector<std::vector<Index>> const& marked,
                                           int max_level) {
  if constexpr (refines_on_backend<Parts>) {
    using On = TopologyOn<typename Parts::mesh_type, typename Parts::backend_type>;
    if (!can_refine_on_backend(parts)) return std::nullopt;
    if (marked[0].empty()) return RefinedOn{};
    auto const& table = std::get<0>(parts.layout.tables);
    using E = typename std::remove_cvref_t<decltype(table)>::element;
    for (Index const e : marked[0])
      check_number<E>("refine", e, static_cast<std::size_t>(table.count()));
    auto on = std::exchange(parts.topology_on, nullptr);  // gone where something throws
    if (!on) on = std::make_shared<On>(std::as_const(parts));
    auto cells = upload(parts.backend, marked[0]);
    auto const count = static_cast<Index>(marked[0].size());
    parts.backend.for_each(count, CellsOfNumbers{on->numbers.cells(), cells.data()});
    auto const refined = on->tree.refine(cells.data(), count,
                                         {parts.limits.nodes, parts.limits.elements, max_level});
    if (refined.leaves > 0) {
      commit_change(parts, "refine", static_cast<std::size_t>(refined.leaves), [&] {
        auto changed = RefinedParts<Parts>(parts, *on, refined).make();
        changed.parts.topology_on = on;
        return changed;
      });
      on->tree.keep();
      on->numbers.find(parts.backend, on->tree, on->order);
    }
    parts.topology_on = on;
    return RefinedOn{static_cast<std::size_t>(refined.leaves),
                     static_cast<std::size_t>(refined.new_nodes)};
  } else {
    return std::nullopt;
  }
}

}  // namespace detail

/// Makes a planned change; listeners wait for tell_listeners. Throws Error, with the body as it was, where
/// fields are not finite, a force term cannot be made anew or memory runs out.
template <class Parts>
void commit(Parts& parts, TopologyPlan<typename Parts::mesh_type> const& plan) {
  HostThreads const threads(parts.backend, *plan.after);
  auto const give_back = [&](auto const& touched, auto const& layout, auto const& held,
                             auto v_before, auto& v) {
    return detail::give_momentum_back(plan, touched, parts.material.density, layout, held,
                                      std::move(v_before), v);
  };
  detail::commit_change(parts, detail::actions_of(plan), detail::count_actions(plan), [&] {
    return change_topology(parts, plan.after, plan.transfer, give_back);
  });
}

/// Tells a body's listeners of a change that was made. What one throws is the caller's: the mesh is changed,
/// and listeners after it are not told.
template <class Parts>
void tell_listeners(Parts const& parts, TopologyPlan<typename Parts::mesh_type> const& plan) {
  for (auto const& listener : parts.listeners) listener({*plan.before, *plan.after, plan.transfer});
}

/// Divides elements of a body: triangles and quadrilaterals into four, tetrahedra, hexahedra and wedges into eight, pyramids
/// into ten (see RefinementPattern). `marked` has, for each element type in the order of the
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
                "meshes change that are of the catalogue's elements, with Tet4 beside Pyramid5");
  detail::check_lists<typename TheBody::mesh_type>("refine", marked);
  if (auto const done = detail::refine_on_backend(body.parts(), marked, max_level))
    return {done->refined, done->new_nodes};
  auto const plan = plan_change(body.parts(), {.refine = marked}, max_level);
  if (!plan) return {};
  commit(body.parts(), *plan);
  tell_listeners(body.parts(), *plan);
  return {plan->counts.refined, plan->transfer.new_nodes().size()};
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
                "meshes change that are of the catalogue's elements, with Tet4 beside Pyramid5");
  detail::check_lists<typename TheBody::mesh_type>("coarsen", marked);
  auto const plan = plan_change(body.parts(), {.coarsen = marked});
  if (!plan) return {};
  commit(body.parts(), *plan);
  tell_listeners(body.parts(), *plan);
  return {plan->counts.coarsened, plan->transfer.gone().size()};
}

/// Gives linear elements of a body the degree two: they become elements of the mesh's quadratic type on the same cell (Tri3
/// Tri6, Quad4 Quad8 or Quad9, Tet4 Tet10, Hex8 Hex20 or Hex27), which the mesh names, with no elements or some, and of
/// which the body has a Group. `marked` as for refine. Beside elements that stay linear, finer ones included, displacements
/// stay linear: nodes there are slaves, so that a patch gains where all elements around an edge are raised (`ring` = 1
/// raises all around those that are marked). Each goes to the group of the same law, or to the first of its type where
/// none has it; then what quadrature points keep begins at rest. New nodes lie in the middle between corners, with the
/// displacement and velocity there; each element keeps its momentum. Facets get the nodes between their corners.
/// Throws Error, with the body as it was, as refine, for elements that are quadratic, and where the mesh has no
/// quadratic type on their cell.
template <DeformableBody TheBody>
RaisingReport raise(TheBody& body, std::vector<std::vector<Index>> const& marked,
                    RaiseOptions options = {}) {
  static_assert(detail::can_be_refined<typename TheBody::mesh_type>,
                "meshes change that are of the catalogue's elements, with Tet4 beside Pyramid5");
  detail::check_lists<typename TheBody::mesh_type>("raise", marked);
  if (options.ring < 0)
    throw Error("raise: a ring of ", options.ring, "; give the number of rings, 0 or more");
  auto const plan = plan_change(body.parts(), {.raise = marked, .raised_rings = options.ring});
  if (!plan) return {};
  commit(body.parts(), *plan);
  tell_listeners(body.parts(), *plan);
  return {plan->counts.raised, plan->transfer.new_nodes().size()};
}

/// Undoes raising, and gives quadratic elements of the initial mesh corners only. Nodes between corners go where no other
/// element has them, and hand their loads to those they lay between; those of the initial mesh stay with their numbers
/// and move with the corners. Elements with nodes that a condition on nodes names stay as they are. Groups, momentum and
/// errors as of raise.
template <DeformableBody TheBody>
LoweringReport lower(TheBody& body, std::vector<std::vector<Index>> const& marked) {
  static_assert(detail::can_be_refined<typename TheBody::mesh_type>,
                "meshes change that are of the catalogue's elements, with Tet4 beside Pyramid5");
  detail::check_lists<typename TheBody::mesh_type>("lower", marked);
  auto const plan = plan_change(body.parts(), {.lower = marked});
  if (!plan) return {};
  commit(body.parts(), *plan);
  tell_listeners(body.parts(), *plan);
  return {plan->counts.lowered, plan->transfer.gone().size()};
}

/// Puts elements of another shape in the place of linear ones, of which no edge or side is divided: a Quad4 becomes four
/// triangles (Tri3) around a new node in its middle, or two (`triangles` = 2) along its shorter diagonal, a Hex8 six
/// pyramids (Pyramid5) around a new node, and two pyramids that share a base, of which one is marked, two Tet4 each along
/// the shorter diagonal of that; other pyramids stay. The mesh names the types that elements become, with no elements or
/// some, and the body has a Group of each. `marked` as for refine. All can be refined further (pyramids into pyramids
/// and Tet4, which a mesh with pyramids names too).
/// A new node takes the displacement and velocity of the middle; each element keeps its momentum. Groups as of raise.
/// Throws Error, with the body as it was, as refine, for elements of other types, where the mesh has not the type that
/// they become, and for another number of triangles.
template <DeformableBody TheBody>
SplittingReport split(TheBody& body, std::vector<std::vector<Index>> const& marked,
                      SplitOptions options = {}) {
  static_assert(detail::can_be_refined<typename TheBody::mesh_type>,
                "meshes change that are of the catalogue's elements, with Tet4 beside Pyramid5");
  detail::check_lists<typename TheBody::mesh_type>("split", marked);
  if (options.triangles != 2 && options.triangles != 4)
    throw Error("split: into ", options.triangles, " triangles; give 2 or 4");
  MarkedElements wanted;
  (options.triangles == 2 ? wanted.split_in_two : wanted.split) = marked;
  auto const plan = plan_change(body.parts(), wanted);
  if (!plan) return {};
  commit(body.parts(), *plan);
  tell_listeners(body.parts(), *plan);
  return {plan->counts.split, plan->transfer.new_nodes().size()};
}

/// Undoes splitting: where all elements that one was split into are marked, and none is refined itself or of degree two, it
/// takes their place; of two pyramids that share a base both or none. The node in its middle goes, unless a condition on nodes names it; then it stays split. Groups,
/// values of elements, internal variables, momentum and loads as of coarsen. Throws Error as refine, and for elements
/// of types that nothing is split into.
template <DeformableBody TheBody>
MergingReport merge(TheBody& body, std::vector<std::vector<Index>> const& marked) {
  static_assert(detail::can_be_refined<typename TheBody::mesh_type>,
                "meshes change that are of the catalogue's elements, with Tet4 beside Pyramid5");
  detail::check_lists<typename TheBody::mesh_type>("merge", marked);
  auto const plan = plan_change(body.parts(), {.merge = marked});
  if (!plan) return {};
  commit(body.parts(), *plan);
  tell_listeners(body.parts(), *plan);
  return {plan->counts.merged, plan->transfer.gone().size()};
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
