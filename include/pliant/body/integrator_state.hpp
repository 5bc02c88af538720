#pragma once

#include <cstdint>
#include <limits>

#include <pliant/backend/backend.hpp>

namespace pliant {

/// Two upper bounds of ω², 1/s²: by the elements' eigenvalues, and by the sums of rows over masses.
struct FrequencyBounds {
  double elements = 0, rows = 0;

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("by elements", r.elements...);
    visit("by rows", r.rows...);
  }
};

/// What implicit integrators keep from call to call, by internal numbers: arrays are empty where something else moved
/// the body last, or a scheme does not need them.
template <Backend B>
struct ImplicitState {
  using Field = typename B::template Array<typename B::scalar>;
  Field a;  // (nodes, 4), m/s²: accelerations, those of held nodes zero
  Field d_before,
      v_before;           // (nodes, 4), m and m/s: the last step, and the velocities where it began
  bool balanced = false;  // whether a is in balance with the present forces
  std::int32_t mass = 0;  // by which MassMatrix it is
  double step = 0;        // s: the size of the last step; 0: there was none
  double next_step = 0;   // s: which its error asks for
  /// (nodes, 4), in m, m/s and m/s²: how far u, v, a, d_before and v_before are off; see CarriedErrors.
  Field error_u, error_v, error_a, error_d_before, error_v_before;
  double error = 0;     // m: by how much displacements may have been off so far
  double farthest = 0;  // m: the largest displacement so far

  bool empty() const { return step == 0; }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("accelerations", r.a...);
    visit("last step", r.d_before...);
    visit("velocities before it", r.v_before...);
    visit("balance of accelerations", r.balanced...);
    visit("masses", r.mass...);
    visit("size of the last step", r.step...);
    visit("size of the next step", r.next_step...);
    visit("errors of displacements", r.error_u...);
    visit("errors of velocities", r.error_v...);
    visit("errors of accelerations", r.error_a...);
    visit("error of the last step", r.error_d_before...);
    visit("errors of velocities before it", r.error_v_before...);
    visit("largest error", r.error...);
    visit("largest displacement", r.farthest...);
  }
};

/// What an integrator keeps from call to call. It stands in the body's state, so that a run that is rolled back
/// or resumed goes on as it would have.
struct IntegratorState {
  bool active = false;    // an explicit integrator has taken this state over
  double step = 0;        // s
  double macro_step = 0;  // s: of level 0 of local steps, before `slower`; 0 without them
  double slower = 1;      // the step is this often smaller than the stable one asks
  std::int64_t slow_for =
      0;  // steps: for how many it stays so after a roll-back; twice as many after the next
  std::int64_t slow_until = 0;  // the step behind which a good check makes it longer again
  double distortion = 0;        // the largest when the step was chosen
  double asked_step = 0;        // s, and the safety: what it was chosen by
  double safety = 0;
  std::int64_t next_check = 0;    // steps
  std::int64_t next_refresh = 0;  // steps
  std::int64_t next_watch = 0;    // steps
  bool bounds_raised = false;     // by changes of the mesh since the step was chosen
  std::int64_t saw_both_at = 0;   // the step at which both bounds of all elements were looked at
  /// Less what was booked, J: what leapfrog keeps, at the start; the total, at the last check.
  double first_energy = std::numeric_limits<double>::quiet_NaN();
  double last_energy = std::numeric_limits<double>::quiet_NaN();
  double last_kept = std::numeric_limits<double>::quiet_NaN();  // what leapfrog keeps, then
  double scale = 0;     // the largest of strain and kinetic energy so far, J
  double unbooked = 0;  // changes that were not booked up to the last check

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("active", r.active...);
    visit("step", r.step...);
    visit("macro step", r.macro_step...);
    visit("slower", r.slower...);
    visit("steps that it stays slower", r.slow_for...);
    visit("step until which it is slower", r.slow_until...);
    visit("distortion", r.distortion...);
    visit("step that was asked for", r.asked_step...);
    visit("safety", r.safety...);
    visit("next check", r.next_check...);
    visit("next refresh", r.next_refresh...);
    visit("next watch", r.next_watch...);
    visit("whether bounds are raised", r.bounds_raised...);
    visit("step at which both bounds were seen", r.saw_both_at...);
    visit("first energy", r.first_energy...);
    visit("last energy", r.last_energy...);
    visit("last energy that is kept", r.last_kept...);
    visit("scale", r.scale...);
    visit("unbooked changes", r.unbooked...);
  }
};

}  // namespace pliant
