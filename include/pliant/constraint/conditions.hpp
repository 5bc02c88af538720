#pragma once

#include <span>

#include <pliant/body/velocities.hpp>
#include <pliant/body/wake.hpp>
#include <pliant/mesh/sides.hpp>

// What a body's conditions make of its nodes, in the backend's memory.
namespace pliant {

namespace detail {
/// v = 0 in some directions of each node.
template <class Parts>
void stop(Parts& parts, DirectionMask const* directions) {
  parts.backend.for_each(parts.layout.rows,
                         StopHeld<typename Parts::T, Parts::dim>{parts.v(), directions});
  parts.layout.interpolation.apply(parts.backend, parts.v());
}
}  // namespace detail

/// v = 0 in the directions that are held or driven.
template <class Parts>
void stop_held(Parts& parts) {
  detail::stop(parts, parts.layout.held.data());
}

/// Asks all motions for a time, s, reached over `over` seconds. Throws Error before anything changes.
template <class Parts>
void ask_motions(Parts& parts, double time, double over) {
  for (auto& driven : parts.driven) driven.ask(time, over);
}
/// Puts driven nodes where their motions were asked for.
template <class Parts>
void place_driven_nodes(Parts& parts) {
  if (parts.driven.empty()) return;
  for (auto const& driven : parts.driven) driven.place(parts.backend, parts.u(), parts.v());
  parts.layout.interpolation.apply(parts.backend, parts.u());
}

namespace detail {
/// 1 where two fields differ, at nodes of elements that interpolate no others.
template <class T, int Dim>
struct DiffersAt {
  NodeField<T const, Dim> a, b;
  T const* mass;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    if (!(mass[i] > T(0))) return 0;
    for (int k = 0; k < Dim; ++k)
      if (a(i, k) != b(i, k)) return 1;
    return 0;
  }
};
}  // namespace detail

/// Displacements as they were before conditions put nodes at the start of their motions, (nodes, 4), m, as long as
/// nothing else has moved since; the present ones otherwise. A static solver's increments start there.
template <class Parts>
typename Parts::template Array<typename Parts::T> const& place_before_drives(Parts const& parts) {
  using T = typename Parts::T;
  auto const& u = parts.state.u;
  auto const& before = parts.before_drives;
  if (before.size() != u.size()) return u;
  // With the present displacements where nodes are driven.
  auto same = zeros<T>(parts.backend, u.size());
  detail::copy_values(parts.backend, before.data(), same.data(), u.size());
  for (auto const& driven : parts.driven)
    driven.copy(parts.backend, parts.u(), node_field<Parts::dim>(same));
  bool const moved =
      parts.backend.maximum(
          parts.layout.rows,
          detail::DiffersAt<T, Parts::dim>{parts.u(), node_field<Parts::dim>(std::as_const(same)),
                                           parts.layout.mass.data()}) > 0;
  return moved ? u : before;
}

/// For place_before_drives, before a condition puts nodes at the start of its motion.
template <class Parts>
void keep_place_before_drives(Parts& parts) {
  using T = typename Parts::T;
  auto const& place = place_before_drives(parts);
  if (&place == &parts.before_drives) return;
  if (parts.before_drives.size() != place.size())
    parts.before_drives = zeros<T>(parts.backend, place.size());
  detail::copy_values(parts.backend, place.data(), parts.before_drives.data(), place.size());
}

/// Which directions of each node some conditions hold or drive, by internal numbers.
template <class Parts>
std::vector<DirectionMask> held_directions(Parts const& parts,
                                           std::span<Condition<Parts::dim> const> conditions) {
  std::vector<DirectionMask> held(static_cast<std::size_t>(parts.layout.rows), 0);
  for (auto const& condition : conditions)
    for (Index node : condition.nodes)
      held[static_cast<std::size_t>(parts.layout.internal_of(node))] |= condition.directions;
  return held;
}

/// Brings masks and lists of driven nodes up to state.prescribed.
template <class Parts>
void upload_conditions(Parts& parts) {
  parts.driven.clear();
  for (auto const& condition : parts.state.prescribed->conditions) {
    if (!condition.motion) continue;
    std::vector<Index> rows;
    std::vector<Point<Parts::dim>> places;
    for (Index node : condition.nodes) {
      rows.push_back(parts.layout.internal_of(node));
      if (!condition.motion.is_uniform()) places.push_back(parts.state.topology->point(node));
    }
    parts.driven.emplace_back(parts.backend, condition.motion, condition.directions,
                              upload(parts.backend, rows), std::move(places),
                              parts.layout.node_rows_when_asked());
  }
  parts.layout.held.upload(held_directions<Parts>(parts, parts.state.prescribed->conditions));
  ++parts.revision;
}

/// The energy that an integrator watches; none while none does.
template <class Parts>
WatchedEnergy present_energy(Parts& parts) {
  return parts.add_watched_term ? watched_energy_of(parts, parts.add_watched_term)
                                : WatchedEnergy{};
}

/// What a change from `before` to `after` added to the energy that an integrator watches and keeps, J; 0 while none
/// does. Where there is no such number, the integrator begins anew.
template <class Parts>
double watched_change(Parts& parts, WatchedEnergy const& before, WatchedEnergy const& after) {
  double const added = after.kept() - before.kept();
  if (!std::isfinite(added)) {
    parts.state.integrator.active = false;
    return 0;
  }
  parts.state.integrator.last_energy += after.acceleration - before.acceleration;
  return added;
}

/// Runs a change of the state by a user's hand: `change()`. Velocities are brought up to the present time
/// first, and all that sleeps wakes. Once an integrator watches the energy, what the change adds to it is booked; forces are
/// evaluated anew, the stable step is asked for again, and roll-back does not cross it.
template <class Parts, class Change>
void change_by_hand(Parts& parts, Change const& change) {
  synchronize_velocities(parts);
  wake_all(parts);
  auto const before = present_energy(parts);
  change();
  forget_forces(parts);
  parts.state.energy_by_hand += watched_change(parts, before, present_energy(parts));
  parts.has_checkpoint = false;
  parts.state.implicit = {};
  parts.state.integrator.next_refresh = parts.state.steps;  // it may have made the body stiffer
}

namespace detail {

/// Throws Error where a condition names nodes that it cannot hold or drive.
template <class Parts>
void check_condition(Parts const& parts, Condition<Parts::dim> const& condition) {
  Index const count = parts.layout.nodes();
  if (condition.nodes.empty())
    throw Error("body: a condition names no node; give the facets or nodes that it is to act on");
  if (condition.directions == 0 || condition.directions > all_directions<Parts::dim>)
    throw Error("body: a condition has the directions ", int{condition.directions},
                "; set bit k for direction k, at least one of ", Parts::dim);
  for (Index node : condition.nodes) {
    if (node < 0 || node >= count)
      throw Error("body: a condition names node ", node, ", but nodes are numbered 0 to ",
                  count - 1);
    if (parts.state.topology->interpolation.row_of(node))
      throw Error("body: node ", node,
                  " hangs between others, whom it follows; hold or drive these instead");
  }
  std::vector<DirectionMask> held(static_cast<std::size_t>(count), 0), driven(held);
  for (auto const& other : parts.state.prescribed->conditions)
    for (Index node : other.nodes)
      (other.motion ? driven : held)[static_cast<std::size_t>(node)] |= other.directions;
  for (Index node : condition.nodes) {
    auto const i = static_cast<std::size_t>(node);
    DirectionMask const others = condition.motion ? held[i] | driven[i] : driven[i];
    if ((others & condition.directions) != 0)
      throw Error("body: node ", node, condition.motion ? " is to be driven" : " is to be held",
                  " in a direction in which another condition ",
                  (driven[i] & condition.directions) != 0 ? "drives" : "holds",
                  " it; release that one first, or leave the node or direction out");
  }
}

/// Puts another set of conditions in force.
template <class Parts>
void prescribe(Parts& parts, Prescribed<Parts::dim> prescribed) {
  parts.state.prescribed = std::make_shared<Prescribed<Parts::dim> const>(std::move(prescribed));
}

}  // namespace detail

/// Adds a condition; see Body::hold and Body::drive. Facets stand for the nodes on them.
template <class Parts>
Handle add_condition(Parts& parts, Condition<Parts::dim> condition) {
  if (!condition.facets.empty()) {
    condition.facets = mesh::sides_of(parts.state.topology->mesh(), condition.facets);
    condition.nodes = nodes_of(condition.facets);
  }
  std::sort(condition.nodes.begin(), condition.nodes.end());
  condition.nodes.erase(std::unique(condition.nodes.begin(), condition.nodes.end()),
                        condition.nodes.end());
  detail::check_condition(parts, condition);
  auto prescribed = *parts.state.prescribed;
  condition.handle = {prescribed.next_id++};
  if (condition.motion) {
    for (Index k = condition.handle.id; condition.name.empty(); ++k)
      if (auto name = "motion " + std::to_string(k); !parts.motions.contains(name))
        condition.name = std::move(name);
    if (std::ranges::find(prescribed.conditions, condition.name, &Condition<Parts::dim>::name) !=
        prescribed.conditions.end())
      throw Error("body.drive: there is a motion called \"", condition.name,
                  "\" already; give each a name of its own");
    for (Index node : condition.nodes)
      (void)detail::position_at<Parts::dim, typename Parts::T>(
          condition.motion, parts.state.topology->point(node), [&] { return node; },
          parts.state.time);
    parts.motions.insert_or_assign(condition.name, condition.motion);
  }
  Handle const handle = condition.handle;
  if (condition.motion) keep_place_before_drives(parts);
  bool const moves = static_cast<bool>(condition.motion);
  auto const own =
      upload(parts.backend, held_directions<Parts>(parts, std::span(&std::as_const(condition), 1)));
  prescribed.conditions.push_back(std::move(condition));
  change_by_hand(parts, [&] {
    detail::prescribe(parts, std::move(prescribed));
    upload_conditions(parts);
    detail::stop(parts, own.data());  // what others drive goes on
    if (!moves) return;
    parts.driven.back().ask(parts.state.time, 0);
    parts.driven.back().place(parts.backend, parts.u(), parts.v());
    parts.layout.interpolation.apply(parts.backend, parts.u());
  });
  return handle;
}

/// Ends a condition or a pressure. Nodes go on with the velocity that they have: none where they were held.
/// Throws Error for a handle that names none.
template <class Parts>
void release(Parts& parts, Handle handle) {
  auto prescribed = *parts.state.prescribed;
  auto const same = [&](auto const& p) { return p.handle == handle; };
  auto const gone = std::erase_if(prescribed.conditions, same);
  auto const pressed = std::erase_if(prescribed.pressures, same);
  if (gone + pressed == 0)
    throw Error("body.release: handle ", handle.id,
                " names no condition or pressure of this body; it was released before, or is of "
                "another body");
  change_by_hand(parts, [&] {
    detail::prescribe(parts, std::move(prescribed));
    upload_conditions(parts);
    if (pressed > 0) {
      parts.upload_pressures(parts);
      make_room_for_forces(parts);
    }
  });
}

}  // namespace pliant
