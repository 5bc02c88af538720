#pragma once

#include <pliant/body/wake.hpp>

// States to go back to.
namespace pliant {

/// Keeps the present state, for roll_back.
template <class Parts>
void keep_checkpoint(Parts& parts) {
  synchronize_velocities(parts);
  if (!parts.checkpoint) parts.checkpoint.emplace();
  copy_state(parts.backend, parts.state, *parts.checkpoint);
  parts.has_checkpoint = true;
}

/// Goes back to the last checkpoint, which is of the present mesh.
template <class Parts>
void roll_back(Parts& parts) {
  double const step = parts.checkpoint->step_size;
  forget_forces(parts);
  parts.checkpoint->step_size = parts.state.step_size;  // set_step_size prepares the laws anew
  copy_state(parts.backend, *parts.checkpoint, parts.state);
  parts.checkpoint->step_size = step;
  set_step_size(parts, step);
  parts.for_each_type([](auto& table, auto&) { table.elements.regroup(); });
  parts.loads_current = false;
  follow_rest(parts);
  parts.schedule.reset();
  ++parts.revision;  // gravity and damping may be others
}

}  // namespace pliant
