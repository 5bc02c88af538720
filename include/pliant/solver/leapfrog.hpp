#pragma once

#include <pliant/constraint/conditions.hpp>

// The steps of central differences (leapfrog, velocity Verlet) on the parts of a body.
namespace pliant {

/// Takes steps of a constant size, with a half-kick pending before and after. Throws Error for a size that is
/// not positive, and where a motion is not finite, at the end of the last step before that.
template <class Parts>
void take_steps(Parts& parts, double dt, int steps) {
  if (!(dt > 0)) throw Error("take_steps: a step of ", dt, " s; give a positive one");
  auto& state = parts.state;
  // Steps that are not like the others.
  auto const special = [&] {
    return state.pending_half_kick != dt / 2 || !parts.driven.empty() || parts.forces_current ||
           (Parts::has_internal_variables && state.step_size != dt);
  };
  for (; steps > 0 && special(); --steps) {
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
  if (steps == 0) return;
  // What allocates or hands loads on to masters is no part of a step.
  (void)external_forces(parts);
  (void)detail::reserve_terms_without_energy(parts);
  if (!parts.recorded || parts.recorded->dt != dt || parts.recorded->revision != parts.revision) {
    parts.recorded =
        typename Parts::Recorded{parts.backend.record([&parts, dt] {
                                   accumulate_forces(parts, std::as_const(parts).u(), parts.f());
                                   commit_at(parts, std::as_const(parts).u());
                                   advance(parts, dt / 2, dt / 2, dt);
                                 }),
                                 dt, parts.revision};
  }
  parts.recorded->recording.replay(steps);
  for (int k = 0; k < steps; ++k) state.time += dt;  // the same bits however steps are grouped
  state.steps += steps;
}

}  // namespace pliant
