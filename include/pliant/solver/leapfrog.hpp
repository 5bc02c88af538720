#pragma once

#include <pliant/constraint/conditions.hpp>

// The steps of central differences (leapfrog, velocity Verlet) on the parts of a body.
namespace pliant {

namespace detail {

/// Whether the next step is not like those that are recorded, whether or not its forces are known.
template <class Parts>
bool next_move_is_special(Parts const& parts, double dt) {
  auto const& state = parts.state;
  return state.pending_half_kick != dt / 2 || !parts.driven.empty() ||
         (Parts::has_internal_variables && state.step_size != dt);
}
template <class Parts>
bool next_step_is_special(Parts const& parts, double dt) {
  return next_move_is_special(parts, dt) || parts.forces_current;
}

/// Whether the next step is like the others but that its forces are known: at the nodes that evaluate_forces leaves them
/// at, which a recording counts on.
template <class Parts>
bool goes_on_from_known_forces(Parts const& parts, double dt) {
  return parts.forces_current && parts.forces_complete == !parts.awake &&
         !next_move_is_special(parts, dt);
}

/// Steps that are not like the others: `steps` of them at the most. Returns how many are left.
template <class Parts>
int take_special_steps(Parts& parts, double dt, int steps) {
  auto& state = parts.state;
  for (; steps > 0 && next_step_is_special(parts, dt); --steps) {
    ask_motions(parts, state.time + dt, dt);
    evaluate_forces(parts);
    commit_at(parts, std::as_const(parts).u());
    advance(parts, state.pending_half_kick, dt / 2, dt);
    set_step_size(parts, dt);
    state.pending_half_kick = dt / 2;
    state.time += dt;
    ++state.steps;
    place_driven_nodes(parts);
  }
  return steps;
}

/// Whether nothing of a body moves or is pulled at, so that time alone goes on.
template <class Parts>
bool all_asleep(Parts const& parts) {
  return parts.awake && parts.awake->awake == 0 && !has_added_terms(parts);
}

/// The loops of a step like the others, once its forces are known.
template <class Parts>
void loop_over_move(Parts& parts, double dt) {
  commit_at(parts, std::as_const(parts).u());
  advance(parts, dt / 2, dt / 2, dt);
}
template <class Parts>
void loop_over_step(Parts& parts, double dt) {
  if (!can_hand_on_in_advance(parts)) {
    accumulate_awake_forces(std::as_const(parts), parts.f());
    return loop_over_move(parts, dt);
  }
  accumulate_own_forces(std::as_const(parts), parts.f());
  commit_at(parts, std::as_const(parts).u());
  advance_handing_on(parts, dt / 2, dt / 2, dt);
}

/// So many steps are taken one launch after the other before those like them are recorded. To record a stretch of steps takes a
/// GPU's host longer than to launch it, and a mesh that changes often has it done in vain.
inline constexpr int steps_before_recording = 16;

/// Does `n` times what f() does in `steps` steps: replays what is recorded of it, where `kept` does not have something else.
template <class Parts, class F>
void replay_steps(Parts& parts, std::optional<typename Parts::Recorded>& kept, double dt, int steps,
                  std::shared_ptr<void const> const& look, int n, F const& f) {
  if (n == 0) return;
  // What allocates or hands loads on to masters is no part of a step.
  (void)external_forces(parts);
  (void)reserve_terms_without_energy(parts);
  prepare_handing_on(parts);
  if (!kept || kept->dt != dt || kept->revision != parts.revision || kept->look != look ||
      kept->steps != steps)
    kept = typename Parts::Recorded{dt, parts.revision, look, steps};
  int left = n;
  for (; left > 0 && !kept->recording && kept->unrecorded < steps_before_recording; --left) {
    f();
    kept->unrecorded += steps;
  }
  if (left > 0) {
    if (!kept->recording) kept->recording = parts.backend.record(f);
    kept->recording->replay(left);
  }
  auto& state = parts.state;
  for (int k = 0; k < n * steps; ++k) state.time += dt;  // the same bits however steps are grouped
  state.steps += n * steps;
}

/// How many steps are recorded together where there are many: what lies between two launches of a GPU takes some
/// 2 µs.
inline constexpr int steps_of_stretch = 8;

}  // namespace detail

/// Takes steps of a constant size, with a half-kick pending before and after. Throws Error for a size that is
/// not positive, and where a motion is not finite, at the end of the last step before that.
template <class Parts>
void take_steps(Parts& parts, double dt, int steps) {
  if (!(dt > 0)) throw Error("take_steps: a step of ", dt, " s; give a positive one");
  if (detail::all_asleep(parts)) {
    parts.state.pending_half_kick = steps > 0 ? dt / 2 : parts.state.pending_half_kick;
    for (int k = 0; k < steps; ++k) parts.state.time += dt;
    parts.state.steps += steps;
    return;
  }
  constexpr int together = detail::steps_of_stretch;
  if (steps >= together && detail::goes_on_from_known_forces(parts, dt)) {
    detail::replay_steps(parts, parts.recorded_onward, dt, together, nullptr, 1, [&parts, dt] {
      detail::loop_over_move(parts, dt);
      for (int k = 1; k < together; ++k) detail::loop_over_step(parts, dt);
    });
    parts.forces_current = parts.forces_complete = false;  // a replay does not tell
    steps -= together;
  }
  steps = detail::take_special_steps(parts, dt, steps);
  auto const replay = [&](auto& kept, int of, int n) {
    detail::replay_steps(parts, kept, dt, of, nullptr, n, [&parts, dt, of] {
      for (int k = 0; k < of; ++k) detail::loop_over_step(parts, dt);
    });
  };
  replay(parts.recorded_stretch, together, steps / together);
  replay(parts.recorded, 1, steps % together);
}

/// Takes as many whole stretches as fit into `steps`, each of look.interval() steps with a look behind them,
/// as one recording, if the next steps are like the others and the look can be recorded. Returns how many
/// steps it took.
template <class Parts, class Look>
int take_stretches(Parts& parts, double dt, int steps, Look const& look) {
  int const interval = look.interval();
  if (steps < interval || detail::next_move_is_special(parts, dt) || !look.can_record(parts))
    return 0;
  bool const forces_known = look.evaluates_forces(parts);  // before each stretch and behind it
  if (parts.forces_current && !forces_known) return 0;
  look.prepare(parts);
  if (forces_known) evaluate_forces(parts);
  int const n = steps / interval;
  detail::replay_steps(parts, parts.recorded_with_look, dt, interval, look.identity(), n,
                       [&parts, dt, interval, look, forces_known] {
                         for (int k = 0; k < interval; ++k)
                           if (k == 0 && forces_known)
                             detail::loop_over_move(parts, dt);
                           else
                             detail::loop_over_step(parts, dt);
                         look.loop_over_look(parts);
                       });
  if (forces_known) {
    parts.forces_current = true;
    parts.forces_complete = !parts.awake;
  }
  return n * interval;
}

}  // namespace pliant
