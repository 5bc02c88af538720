#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <pliant/body/leapfrog_energy.hpp>
#include <pliant/solver/distortion.hpp>
#include <pliant/solver/energy_check.hpp>
#include <pliant/solver/leapfrog.hpp>
#include <pliant/solver/raise_bounds.hpp>
#include <pliant/solver/stable_step.hpp>
#include <pliant/solver/stiffening.hpp>

namespace pliant {

struct CentralDifferenceOptions {
  double safety = 0.9;          // times the guaranteed stable step
  double step = 0;              // s; 0: from stable_step
  int check_interval = 256;     // steps between checks of finiteness and energy
  int refresh_interval = 1024;  // steps between evaluations of the stable step, at the most
  int watch_interval = 16;  // steps between looks at the distortion, which may ask for one earlier
  /// A chosen step gets longer when this share more would be stable. One that followed each swing of a body would pump
  /// energy: what leapfrog keeps depends on the step.
  double hysteresis = 0.1;
  /// What counts as a blow-up: growth of the total energy since the last check, over strain and kinetic
  /// energy, which beyond the stable step is many times (at safety 0.94 that of the highest mode swings
  /// by 0.9 of its largest), and more than the loads' accelerations explain; and growth of the energy that leapfrog keeps since the start, or a fall since the last check, over the
  /// largest of these so far; energies below what rounding makes of a body at rest, 64 ε E V, count as that much. The work of loads, pressures, driven nodes and damping is booked, and no
  /// growth. Not looked at with laws that have internal variables, which may give back what the strain
  /// energy does not count, nor while there are driven nodes or pressures, whose work would hide it: then
  /// only a state that is not finite is a blow-up.
  double energy_growth = 0.9, energy_drift = 0.02;
};

/// What a call of an integrator did.
struct Advanced {
  std::int64_t steps = 0;    // by which the body's count went forward; negative after a roll-back
  double time = 0;           // s: where the body is now
  double step = 0;           // s: the size of the last step
  bool rolled_back = false;  // to a time before the call: set anew what depends on the present one
  /// The last step at which the state was found good, which is where a roll-back would go; −1 where it was not looked at
  /// since it was changed by hand. What came after may turn out not to be finite.
  std::int64_t checked = -1;
};

namespace detail {
template <class Parts>
Advanced advanced(Parts const& parts, std::int64_t begun, double step, bool rolled_back) {
  return {parts.state.steps - begun, parts.state.time, step, rolled_back,
          parts.has_checkpoint ? parts.checkpoint->steps : -1};
}
}  // namespace detail

/// Explicit time integration by central differences (leapfrog, velocity Verlet), with lumped masses and mass
/// damping. At intervals the state is checked: one that went non-finite, or whose energy grew by more
/// than its loads and its adaptation explain, is rolled back to the last check and done again with half
/// the step; after three halvings it throws Error, and the body is at the last good state. The smaller step
/// stays for four check intervals, twice as long after each further roll-back; one that was given in options
/// stays halved until another CentralDifference takes the body over. What a user set is not rolled back: gravity,
/// damping and loads act as they were set last. A call that is rolled back behind its own begin returns
/// there, so that its caller can set what depends on time. A change of the mesh has the step chosen anew: by the rows of the
/// stiffness that it changed where rows told what is stable, else by all elements (see detail::raise_bounds).
class CentralDifference {
 public:
  explicit CentralDifference(CentralDifferenceOptions options = {}) : options_(options) {
    if (!(options.safety > 0 && options.safety <= 1) ||
        !(options.step >= 0 && std::isfinite(options.step)) || options.check_interval < 1 ||
        options.refresh_interval < 1 || options.watch_interval < 1 ||
        !(options.hysteresis >= 0 && std::isfinite(options.hysteresis)) ||
        !(options.energy_growth >= 0) || !(options.energy_drift >= 0))
      throw Error(
          "CentralDifference: safety must be in (0, 1], intervals at least 1, and step, "
          "hysteresis, energy_growth and energy_drift not negative");
  }

  /// The size of the last step, s.
  double step() const { return step_; }
  /// How often a stretch was rolled back and done again.
  int retries() const { return retries_; }

  /// Takes steps.
  template <DeformableBody TheBody>
  Advanced operator()(TheBody& body, int steps = 1) {
    return advance_by(body, steps,
                      [](auto& parts, double dt, int count) { take_steps(parts, dt, count); });
  }
  /// Takes steps and lets an Adaptation look after each, as a loop over `step(body); adapt(body);` does; on a
  /// GPU the steps between two looks and the look that follows are one launch where no rule of it refines.
  template <DeformableBody TheBody, class TheAdaptation>
  Advanced operator()(TheBody& body, int steps, TheAdaptation& adapt) {
    return advance_by(body, steps, [&](auto& parts, double dt, int count) {
      int const before = adapt.steps_to_look(body);
      if (before == adapt.interval())
        if (int const taken = adapt.take_stretches(
                body,
                [&](auto const& look) { return pliant::take_stretches(parts, dt, count, look); });
            taken > 0)
          return;
      take_steps(parts, dt, std::min(count, before));
      adapt.between_steps(body);
    });
  }
  /// Looks at the present state as steps do at intervals, and goes back to the last good one where it is not good: before
  /// use is made of what no call has looked at (see Advanced::checked). Costs some two steps.
  template <DeformableBody TheBody>
  Advanced check(TheBody& body) {
    auto& parts = body.parts();
    std::int64_t const begun = parts.state.steps;
    begin(parts);
    bool const good = is_good(parts);
    return detail::advanced(parts, begun, parts.state.integrator.step, !good);
  }

 private:
  /// take(parts, dt, n) takes at least one and at most n steps of size dt.
  template <DeformableBody TheBody, class Take>
  Advanced advance_by(TheBody& body, int steps, Take const& take) {
    if (steps < 0) throw Error("CentralDifference: ", steps, " steps; give 0 or more");
    auto& parts = body.parts();
    auto& state = parts.state;
    std::int64_t const begun = state.steps, goal = begun + steps;
    begin(parts);
    auto& own = state.integrator;
    std::int64_t checked = -1;  // at which step
    while (state.steps < goal) {
      if (parts.awake && state.steps >= state.rest_until) wake_all(parts);  // nobody looks any more
      if (state.steps >= own.next_watch && state.steps < own.next_refresh) watch(parts);
      bool const due =
          !parts.has_checkpoint || state.steps >= std::min(own.next_check, own.next_refresh);
      if (due && checked != state.steps) {
        // A step is chosen for a good state only.
        if (is_good(parts)) checked = state.steps;
        if (state.steps < begun) return detail::advanced(parts, begun, own.step, true);
        if (checked != state.steps) continue;
      }
      if (state.steps >= own.next_refresh)
        refresh(parts);
      else if (own.bounds_raised)
        choose(parts, 2 / std::sqrt(detail::squared_frequency(parts, state.bounds)));
      step_ = own.step;
      take(parts, own.step,
           static_cast<int>(std::min({goal, own.next_check, own.next_refresh, own.next_watch,
                                      parts.awake ? state.rest_until : goal}) -
                            state.steps));
    }
    return detail::advanced(parts, begun, own.step, false);
  }

  /// Takes over a state that another integrator, or none, has advanced so far.
  template <class Parts>
  void begin(Parts& parts) {
    parts.add_watched_term = add_acceleration_term<Parts>;
    if constexpr (!Parts::has_internal_variables)  // bounds of whose laws depend on the step
      parts.raise_bounds = detail::raise_bounds<Parts>;
    auto& own = parts.state.integrator;
    std::int64_t const now = parts.state.steps;
    bool const resumed = own.active && own.macro_step == 0 && parts.integrator == nullptr;
    if (own.active && (parts.integrator == identity_ || resumed)) {
      parts.integrator = identity_;
      if (own.asked_step != options_.step || own.safety != options_.safety) own.next_refresh = now;
      own.next_check = std::min(own.next_check, now + options_.check_interval);
      own.next_refresh = std::min(own.next_refresh, now + options_.refresh_interval);
      own.next_watch = std::min(own.next_watch, now + options_.watch_interval);
      return;
    }
    parts.integrator = identity_;
    parts.has_checkpoint = false;
    parts.state.implicit = {};
    own = IntegratorState{.active = true, .step = own.step};  // refresh books a change of the step
    own.next_check = own.next_refresh = own.next_watch = now;
  }

  /// A look at how much the elements are distorted: where that has changed, the stable step has too, and there
  /// is something to check.
  template <class Parts>
  void watch(Parts& parts) {
    auto& own = parts.state.integrator;
    own.next_watch = parts.state.steps + options_.watch_interval;
    if (asks_for_step(parts)) own.next_refresh = parts.state.steps;
  }

  template <class Parts>
  void refresh(Parts& parts) {
    auto& own = parts.state.integrator;
    double const distortion = largest_distortion(parts);
    double const stable =
        options_.step > 0 ? 0 : awake_stable_step_of(parts, options_.refresh_interval);
    // Nothing throws from here on: a step that could not be chosen is asked for again.
    own.next_refresh = parts.state.steps + options_.refresh_interval;
    own.next_watch = parts.state.steps + options_.watch_interval;
    own.distortion = distortion;
    forget_stiffened(parts);
    choose(parts, stable);
  }

  /// Chooses the step by one that is stable, s, unless a user asked for his.
  template <class Parts>
  void choose(Parts& parts, double stable) {
    auto& own = parts.state.integrator;
    double step = (options_.step > 0 ? options_.step : options_.safety * stable) / own.slower;
    bool const like_before = own.asked_step == options_.step && own.safety == options_.safety;
    if (like_before && step > own.step && step <= (1 + options_.hysteresis) * own.step)
      step = own.step;
    own.asked_step = options_.step;
    own.safety = options_.safety;
    own.bounds_raised = false;
    if (step == own.step) return;
    // The energy that leapfrog keeps depends on the step.
    double const change = (own.step * own.step - step * step) * acceleration_term(parts);
    if (std::isfinite(change)) {
      parts.state.energy_of_steps += change;
      own.last_energy -= change;
    } else {
      detail::forget_energies(own);
    }
    own.step = step;
  }

  /// What its check of a state asks of it.
  template <class Parts>
  struct Checked {
    Parts& parts;
    double acceleration = 0;  // J: what leapfrog's energy has less than the total

    void add_term(double* to) const { add_acceleration_term(parts, to); }
    detail::CheckedEnergy energy(double total, double term, detail::Booked const& booked) {
      auto& own = parts.state.integrator;
      acceleration = square(own.step) * term;
      if (booked.not_finite != std::exchange(own.unbooked, booked.not_finite))
        detail::forget_energies(own);
      return {total - booked.energy, total - acceleration - booked.energy};
    }
    /// Whether the total has no more over what leapfrog keeps than a stable step leaves it: of linear laws, whose
    /// forces are the loads and those of the strain energy, √A ≤ √A_loads + ω Δt/2 √W. So a load that
    /// comes at once is no growth, whenever it comes.
    bool explains(double growth) const {
      double const bound = step() * std::sqrt(load_term(parts)) + std::sqrt(growth);
      return !(acceleration > bound * bound);
    }
    double step() const { return parts.state.integrator.step; }
    void go_back() const { roll_back_motion(parts); }
    void set_slower(double slower) const { parts.state.integrator.slower = slower; }
  };
  /// Whether the state is good; if not, it is rolled back. Keeps a good one.
  template <class Parts>
  bool is_good(Parts& parts) {
    detail::EnergyCheck const how{"CentralDifference",   "step",
                                  "a smaller step",      options_.energy_growth,
                                  options_.energy_drift, options_.check_interval};
    Checked<Parts> checked{parts};
    if (detail::check_energy(parts, how, checked)) return true;
    ++retries_;
    return false;
  }

  CentralDifferenceOptions options_;
  std::shared_ptr<void const> identity_ = std::make_shared<char>();  // copies share it
  double step_ = 0;
  int retries_ = 0;
};

}  // namespace pliant
