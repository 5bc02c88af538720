#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <pliant/solver/central_difference.hpp>
#include <pliant/solver/coarsest_step.hpp>
#include <pliant/solver/macro_steps.hpp>
#include <pliant/solver/make_schedule.hpp>

namespace pliant {

struct LocalStepsOptions {
  double safety = 0.8;      // times the guaranteed stable step of each element; 0.85 at the most
  double macro_step = 0;    // s: of the coarsest elements; 0: what takes the fewest evaluations
  double hysteresis = 0.1;  // a step gets longer when this share more than it would be stable
  int check_interval = 64;  // macro steps between checks of finiteness and energy
  int refresh_interval =
      256;  // macro steps between evaluations of the elements' stable steps, at the most
  int watch_interval =
      8;  // macro steps between looks at the distortion, which may ask for one earlier
  /// See CentralDifferenceOptions.
  double energy_growth = 0.9, energy_drift = 0.02;
};

/// Explicit time integration in which each element has its own time step, of length T/2^level: impulses by
/// level (r-RESPA: Tuckerman, Berne and Martyna 1992; asynchronous variational integrators with steps
/// that divide each other: Lew, Marsden, Ortiz and West 2003). An element of level l adds T/2^l times
/// its force to the momentum of its nodes; a node moves with the finest element around it. Symplectic and
/// of second order; linear momentum is kept to rounding. With one level it is CentralDifference.
///
/// Levels follow from 2/√λ_max(M_e⁻¹ K_e), with two rings of overlap (see make_schedule); they change at the ends
/// of macro steps, which a call takes. Driven nodes go with the finest step. Velocities belong to the
/// displacements after each call, so that one evaluates all elements once more than it takes macro steps:
/// ask for several where nothing happens in between. Internal variables are committed where the step of their
/// element ends; laws whose stress depends on how fast they deform (KelvinVoigt) are refused.
///
/// State and energy are checked as CentralDifference does, at the ends of macro steps.
class LocalSteps {
 public:
  explicit LocalSteps(LocalStepsOptions options = {}) : options_(options) {
    if (!(options.safety > 0 && options.safety <= 0.85))
      throw Error("LocalSteps: the safety is ", options.safety,
                  "; give one in (0, 0.85]: above, some graded meshes are unstable");
    if (!(options.macro_step >= 0 && std::isfinite(options.macro_step)) ||
        !(options.hysteresis >= 0 && std::isfinite(options.hysteresis)) ||
        options.check_interval < 1 || options.refresh_interval < 1 || options.watch_interval < 1 ||
        !(options.energy_growth >= 0) || !(options.energy_drift >= 0))
      throw Error(
          "LocalSteps: macro_step, hysteresis, energy_growth and energy_drift must not be "
          "negative, and intervals at least 1");
  }

  /// The size of the last macro step, s.
  double macro_step() const { return step_; }
  /// How often a stretch was rolled back and done again.
  int retries() const { return retries_; }

  /// Takes macro steps; they are the steps that the body counts.
  template <DeformableBody TheBody>
  Advanced operator()(TheBody& body, int macro_steps = 1) {
    static_assert(!TheBody::parts_type::has_dashpots,
                  "LocalSteps takes no laws whose stress depends on how fast they deform "
                  "(KelvinVoigt): what a macro step begins with would lack it; use "
                  "CentralDifference");
    if (macro_steps < 0) throw Error("LocalSteps: ", macro_steps, " steps; give 0 or more");
    auto& parts = body.parts();
    auto& state = parts.state;
    std::int64_t const begun = state.steps, goal = begun + macro_steps;
    begin(parts);
    if (macro_steps == 0) return detail::advanced(parts, begun, step_, false);
    auto& own = state.integrator;
    std::int64_t checked = -1;                                // at which step
    if (!parts.has_checkpoint) own.next_watch = state.steps;  // changed by hand
    if (own.macro_step > 0) {
      if (!parts.schedule) restore(parts);
      if (!parts.schedule || groups_changed(parts)) own.next_refresh = state.steps;
    }
    while (state.steps < goal) {
      if (state.steps >= own.next_watch) watch(parts);
      bool const due =
          !parts.has_checkpoint || state.steps >= std::min(own.next_check, own.next_refresh);
      if (due && checked != state.steps) {
        if (is_good(parts)) checked = state.steps;  // levels are chosen for a good state only
        if (state.steps < begun) return detail::advanced(parts, begun, step_, true);
        if (checked != state.steps) continue;
      }
      if (state.steps >= own.next_refresh) refresh(parts);
      step_ = own.macro_step / own.slower;
      take_macro_steps(
          parts, step_,
          static_cast<int>(std::min({goal, own.next_check, own.next_refresh, own.next_watch}) -
                           state.steps));
    }
    return detail::advanced(parts, begun, step_, false);
  }
  /// Takes macro steps and lets an Adaptation look after each, as a loop over `step(body); adapt(body);` does. All
  /// is awake meanwhile.
  template <DeformableBody TheBody, class TheAdaptation>
  Advanced operator()(TheBody& body, int macro_steps, TheAdaptation& adapt) {
    std::int64_t const begun = body.steps(), goal = begun + macro_steps;
    do {
      auto const left = std::min<std::int64_t>(goal - body.steps(), adapt.steps_to_look(body));
      (*this)(body, static_cast<int>(left));
      if (body.steps() < begun) break;
      if (macro_steps > 0) adapt(body);
    } while (body.steps() < goal);
    return detail::advanced(body.parts(), begun, step_, body.steps() < begun);
  }
  /// See CentralDifference::check.
  template <DeformableBody TheBody>
  Advanced check(TheBody& body) {
    auto& parts = body.parts();
    std::int64_t const begun = parts.state.steps;
    begin(parts);
    if (parts.state.integrator.macro_step > 0 && !parts.schedule) restore(parts);
    bool const good = is_good(parts);
    return detail::advanced(parts, begun, step_, !good);
  }

 private:
  /// Takes over a state that another integrator, or none, has advanced so far.
  template <class Parts>
  void begin(Parts& parts) {
    synchronize_velocities(parts);
    wake_all(parts);
    if (Parts::has_internal_variables && parts.state.step_size != 0) {
      commit_at(parts, std::as_const(parts).u());
      set_step_size(parts, 0);  // each element has its own
    }
    parts.add_watched_term = add_acceleration_term<Parts>;  // without a step of its own: the total
    auto& own = parts.state.integrator;
    bool const resumed = own.active && own.macro_step > 0 && parts.integrator == nullptr;
    bool const mine = own.active && parts.integrator == identity_;
    parts.integrator = identity_;
    if (mine || resumed) return;
    parts.has_checkpoint = false;
    parts.schedule.reset();
    parts.state.implicit = {};
    own = IntegratorState{.active = true};
    own.next_check = own.next_refresh = own.next_watch = parts.state.steps;
  }

  /// Makes the schedule that a state had which was loaded or rolled back to.
  template <class Parts>
  void restore(Parts& parts) const {
    bool whole = true;
    parts.for_each_type([&](auto& table, auto& elements) {
      whole = whole && elements.step_levels.size() == static_cast<std::size_t>(table.count());
    });
    if (whole) make_schedule(parts);
  }

  /// A look at how much each element is distorted: where that has changed by as much as a stretch by 1.07 at
  /// rest does, stable steps may have by a tenth.
  template <class Parts>
  void watch(Parts& parts) {
    auto& own = parts.state.integrator;
    own.next_watch = parts.state.steps + options_.watch_interval;
    if (own.next_refresh > parts.state.steps && !(detail::distortion_change(parts) <= 0.02))
      own.next_refresh = parts.state.steps;
  }

  /// Chooses levels for the present state.
  template <class Parts>
  void refresh(Parts& parts) {
    auto& own = parts.state.integrator;
    own.next_refresh = parts.state.steps + options_.refresh_interval;
    detail::keep_distortions(parts);
    change_steps(parts, [&] {
      double const coarsest =
          detail::choose_coarsest_step(parts, options_.macro_step, options_.safety);
      bool const anew = own.macro_step != options_.safety * coarsest;
      own.macro_step = options_.safety * coarsest;
      parts.for_each_type([&](auto& table, auto& elements) {
        auto const count = static_cast<std::size_t>(table.count());
        if (anew || elements.step_levels.size() != count)
          elements.step_levels = zeros<StepLevel>(parts.backend, count);
        parts.backend.for_each(table.count(),
                               detail::AssignLevel<typename Parts::T>{
                                   table.scratch.data(), elements.step_levels.data(),
                                   4 / (coarsest * coarsest), 1 + options_.hysteresis});
      });
      make_schedule(parts);
    });
    if (!std::isfinite(own.first_energy)) own.first_energy = own.last_energy - correction(parts);
  }

  /// Calls change(), which changes the schedule or the size of steps, and books what that adds to the energy that they
  /// keep.
  template <class Parts, class Change>
  static void change_steps(Parts& parts, Change const& change) {
    auto& own = parts.state.integrator;
    bool const compares = parts.schedule && std::isfinite(own.first_energy);
    double const before = compares ? correction(parts) : 0;
    change();
    if (!compares) return;
    double const added = before - correction(parts);
    if (std::isfinite(added)) {
      parts.state.energy_of_steps += added;
      own.last_energy -= added;
    } else {
      detail::forget_energies(own);
    }
  }

  /// What the total energy at the end of a macro step has over that of the steps around.
  template <class Parts>
  static double correction(Parts& parts) {
    auto const& own = parts.state.integrator;
    return half_kick_energy(parts, own.macro_step / own.slower);
  }

  /// What its check of a state asks of it.
  template <class Parts>
  struct Checked {
    LocalSteps const& integrator;
    Parts& parts;

    void add_term(double*) const {}
    detail::CheckedEnergy energy(double total, double, detail::Booked const& booked) const {
      // Of the present levels, once there are some; a change by hand begins the comparison anew.
      auto& own = parts.state.integrator;
      if (!parts.has_checkpoint) own.first_energy = std::numeric_limits<double>::quiet_NaN();
      // Loads that come at once let what is kept fall, by the half-kicks: only growth tells.
      own.last_kept = std::numeric_limits<double>::quiet_NaN();
      double const kept = parts.schedule ? total - booked.energy - correction(parts)
                                         : std::numeric_limits<double>::quiet_NaN();
      return {total - booked.energy, kept};
    }
    bool explains(double) const { return false; }
    double step() const { return integrator.step_; }
    void go_back() const {
      roll_back(parts);
      integrator.restore(parts);
    }
    void set_slower(double slower) const {
      change_steps(parts, [&] { parts.state.integrator.slower = slower; });
    }
  };
  /// Whether the state is good; if not, it is rolled back. Keeps a good one.
  template <class Parts>
  bool is_good(Parts& parts) {
    detail::EnergyCheck const how{"LocalSteps",          "macro step",
                                  "less safety",         options_.energy_growth,
                                  options_.energy_drift, options_.check_interval};
    Checked<Parts> const checked{*this, parts};
    if (detail::check_energy(parts, how, checked)) return true;
    ++retries_;
    return false;
  }

  LocalStepsOptions options_;
  std::shared_ptr<void const> identity_ = std::make_shared<char>();  // copies share it
  double step_ = 0;
  int retries_ = 0;
};

}  // namespace pliant
