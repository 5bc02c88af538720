#pragma once

#include <vector>

#include <pliant/body/carried_nodes.hpp>
#include <pliant/body/carried_points.hpp>
#include <pliant/body/changed_rows.hpp>
#include <pliant/body/checkpoint.hpp>
#include <pliant/body/converted_elements.hpp>
#include <pliant/body/finite_fields.hpp>
#include <pliant/body/ledger.hpp>
#include <pliant/body/point_visitors.hpp>
#include <pliant/body/set_state.hpp>
#include <pliant/body/touched_energy.hpp>

// Another topology for a body: every field goes over by one Transfer.
namespace pliant {

namespace detail {

/// Brings the internal variables of some elements (by the user's number) to rest. `tags`: by the internal number.
template <class Parts, class Table>
void put_points_to_rest(Parts& parts, Table& table, std::vector<Tag> tags,
                        std::vector<bool> const& which) {
  if constexpr (Table::Laws::internal_variable_count > 0) {
    auto const& user = table.user_elements();
    for (std::size_t e = 0; e < tags.size(); ++e)
      if (which[static_cast<std::size_t>(user[e])]) tags[e] = static_cast<Tag>(Table::groups);
    auto const before = upload(parts.backend, tags);
    table.elements.regroup();
    parts.backend.template visit<Table::groups>(
        table.elements,
        CarryInternalVariables<typename Parts::T, typename Table::Laws>{table.laws, before.data()},
        parts.no_counters, parts.rest(), std::as_const(parts).u());
  }
}

/// Conditions and pressures on the new mesh.
template <int Dim>
Prescribed<Dim> carried(Prescribed<Dim> prescribed, Transfer<Dim> const& transfer) {
  for (auto& pressure : prescribed.pressures)
    if (auto facets = transfer.changed_facets(pressure.facets))
      pressure.facets = std::move(*facets);
  for (auto& condition : prescribed.conditions) {
    if (condition.facets.empty()) {
      for (Index& node : condition.nodes) node = transfer.renumbered(node);
      continue;
    }
    auto facets = transfer.changed_facets(condition.facets);
    if (!facets || *facets == condition.facets) continue;
    condition.facets = std::move(*facets);
    condition.nodes = nodes_of(condition.facets);
  }
  return prescribed;
}

}  // namespace detail

/// The parts of a body as they would be on another topology: its state with arrays of elements at rest, and none of
/// nodes, which wait to be filled. put_in_force makes them the body's.
template <class Parts>
Parts parts_on(Parts const& parts, typename Parts::layout_type layout,
               WhenAsked<Topology<typename Parts::mesh_type>> topology,
               decltype(Parts::state.prescribed) prescribed) {
  Parts next{.backend = parts.backend,
             .material = parts.material,
             .groups = parts.groups,
             .layout = std::move(layout)};
  copy_state_without_arrays(parts.backend, parts.state, next.state);
  next.state.topology = std::move(topology);
  next.state.prescribed = std::move(prescribed);
  next.state.load = {};
  next.state.pending_half_kick = 0;
  next.upload_pressures = parts.upload_pressures;
  next.term_makers = parts.term_makers;
  next.add_watched_term = parts.add_watched_term;
  next.revision = parts.revision;
  make_arrays_of_elements(next);
  return next;
}

/// Brings all that follows from the state's topology, conditions and groups up to them.
template <class Parts>
void follow_state(Parts& parts) {
  parts.for_each_type([](auto& table, auto&) { table.elements.regroup(); });
  if (parts.state.load.size() > 0) make_loads(parts);
  upload_conditions(parts);
  if (parts.upload_pressures) parts.upload_pressures(parts);
  renew_terms(parts);
  make_room_for_forces(parts);
  set_step_size(parts, std::exchange(parts.state.step_size, 0.0));  // its laws are new
  follow_rest(parts);
}

/// Makes parts that parts_on gave those of the body, and cannot fail: whatever throws has thrown before. What is
/// recorded, and checkpoints, go.
template <class Parts>
void put_in_force(Parts& parts, Parts next) noexcept {
  parts.recorded.reset();
  parts.recorded_stretch.reset();
  parts.recorded_onward.reset();
  parts.recorded_with_look.reset();
  parts.schedule.reset();
  parts.solver.reset();
  parts.before_drives = {};
  parts.patch_nodes = std::move(next.patch_nodes);
  parts.awake = std::move(next.awake);
  parts.checkpoint.reset();
  parts.has_checkpoint = false;
  parts.scratch.reset();
  parts.layout = std::move(next.layout);
  parts.topology_on = std::move(next.topology_on);
  parts.state = std::move(next.state);
  parts.pressures = std::move(next.pressures);
  parts.upload_pressures = next.upload_pressures;
  parts.sleep = next.sleep;
  parts.terms = std::move(next.terms);
  parts.driven = std::move(next.driven);
  parts.no_counters = std::move(next.no_counters);
  parts.row_sums = {};
  parts.without_energy = {};
  parts.forces_current = next.forces_current;
  parts.forces_complete = next.forces_complete;
  parts.loads_current = next.loads_current;
  parts.revision = next.revision + 1;
}

/// Energies of a body before or after a change of its mesh, J: the strain energy of elements that are touched and of force
/// terms, and the kinetic energy of all nodes.
struct ChangedEnergy {
  double strain = 0, kinetic = 0;
};

/// A body's parts on another topology, and what held nodes took.
template <class Parts>
struct ChangedTopology {
  Parts parts;
  Point<Parts::dim> taken;  // N s
  ChangedEnergy before{}, after{};
  ChangedRows<typename Parts::backend_type> changed_rows{};
};

/// Takes all fields over to another topology, for put_in_force. give_back(touched elements, layout, held, v before, v) may
/// change the velocities v that the transfer gives, at the nodes that the change looks at, and returns the impulse that held
/// nodes took, N s.
/// The body is awake. Throws Error where fields are not finite; the body itself is left as it is.
template <class Parts, class GiveBack>
ChangedTopology<Parts> change_topology(
    Parts& parts, std::shared_ptr<Topology<typename Parts::mesh_type> const> topology,
    Transfer<Parts::dim> const& transfer, GiveBack const& give_back) {
  constexpr int dim = Parts::dim;
  double const kinetic_before = detail::kinetic_energy_of_finite(parts);
  detail::TouchedElements<typename Parts::mesh_type> const touched(
      *parts.state.topology, *topology, transfer,
      [&](std::vector<Index> const& at) { return detail::ElementsAtNodes<Parts>(parts, at); });
  detail::CarriedNodes<Parts> const nodes(parts, *topology, transfer, touched);
  auto const u = nodes.after(nodes.before(parts.state.u));
  auto v_before = nodes.before(parts.state.v);
  auto v = nodes.after(v_before);
  std::vector<Point<dim>> loads;
  if (parts.state.load.size() > 0) loads = parts.layout.in_user_order(parts.state.load);
  std::vector<std::vector<Tag>> groups, tags;  // by type: before and after
  std::vector<detail::CarriedPoints> points;
  auto const kept = detail::kept_points(std::as_const(parts));
  parts.for_each_type([&](auto const& table, auto const&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    groups.push_back(user_groups<typename Table::element>(std::as_const(parts)));
  });
  double const energy_before = detail::energy_of_some(
      std::as_const(parts),
      [&]<Element E>(auto const& visit) { touched.template visit_before<E>(visit); }, groups);
  parts.for_each_type([&](auto const& table, auto const&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    std::size_t const type = tags.size();
    tags.push_back(detail::carried_groups<Table>(std::as_const(parts), groups, transfer, type));
    points.push_back(detail::carried_points<Table>(kept, tags.back(), transfer, type));
  });
  auto prescribed =
      std::make_shared<Prescribed<dim> const>(detail::carried(*parts.state.prescribed, transfer));

  typename Parts::layout_type layout(parts.backend, *topology, parts.material, parts.groups,
                                     parts.layout, transfer, touched, nodes.looked_at());
  std::vector<DirectionMask> held(static_cast<std::size_t>(topology->nodes()),
                                  0);  // by the user's number
  for (auto const& condition : prescribed->conditions)
    for (Index node : condition.nodes) held[static_cast<std::size_t>(node)] |= condition.directions;
  Point<dim> const taken = give_back(touched, layout, held, std::move(v_before), v);

  // As they are, and not by the body's setters, which stop driven nodes.
  ChangedTopology<Parts> changed{
      parts_on(parts, std::move(layout), std::move(topology), std::move(prescribed)),
      taken,
      {energy_before, kinetic_before}};
  auto& next = changed.parts;
  auto& state = next.state;
  state.record.totals = detail::closed_totals(parts);
  state.record.born = state.steps;
  state.u = nodes.onto(next.layout, parts.state.u, u);
  state.v = nodes.onto(next.layout, parts.state.v, v);
  next.layout.freed_rows = {};
  next.layout.interpolation.apply(next.backend, next.u(), next.v());
  if (!loads.empty()) {
    loads = transfer.carry_sums(std::move(loads));
    state.load = upload(next.backend, next.layout.padded(loads));
  }
  std::size_t type = 0;
  next.for_each_type([&](auto& table, auto& of_type) {
    using Table = std::remove_cvref_t<decltype(table)>;
    auto const internal = table.tags_in_internal_order(tags[type]);
    if constexpr (Table::groups > 1) of_type.tags.upload(internal);
    auto const& own = points[type++];
    of_type.internal_variables.upload(table.in_internal_order(own.rows));
    of_type.statistics = {};
    if (!own.at_rest.empty()) detail::put_points_to_rest(next, table, internal, own.at_rest);
  });
  follow_state(next);
  state.integrator.next_check = state.integrator.next_refresh = state.steps;
  state.implicit = {};
  changed.changed_rows =
      detail::changed_rows(parts, next.layout, touched.nodes(),
                           transfer.staying_nodes() < transfer.old_nodes(), touched.displaces());
  changed.after = {
      detail::energy_of_some(
          std::as_const(next),
          [&]<Element E>(auto const& visit) { touched.template visit_after<E>(visit); }, tags),
      kinetic_energy_of(next)};
  return changed;
}

}  // namespace pliant
