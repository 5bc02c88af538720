#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <pliant/body/ledger.hpp>
#include <pliant/solver/stable_step.hpp>

namespace pliant {

struct CentralDifferenceOptions {
  double safety = 0.9;          // times the guaranteed stable step
  double step = 0;              // s; 0: from stable_step
  int check_interval = 256;     // steps between checks of finiteness and energy
  int refresh_interval = 1024;  // steps between evaluations of the stable step
  /// Growth of the total energy between checks, over strain and kinetic energy, that counts as a
  /// blow-up. Not looked at while nodes are driven or facets pressed, which does work, nor with laws
  /// that have internal variables: they may give back what the strain energy does not count.
  double energy_growth = 0.1;
};

/// Explicit time integration by central differences (leapfrog, velocity Verlet), with lumped masses
/// and centred mass damping. At intervals the state is checked: one that went non-finite, or whose
/// energy grew by more than its loads and its adaptation explain, is rolled back to the last check and
/// done again with half the step; after three halvings it throws Error, and the body is at the last
/// good state.
class CentralDifference {
 public:
  explicit CentralDifference(CentralDifferenceOptions options = {}) : options_(options) {
    if (!(options.safety > 0 && options.safety <= 1) ||
        !(options.step >= 0 && std::isfinite(options.step)) || options.check_interval < 1 ||
        options.refresh_interval < 1 || !(options.energy_growth >= 0))
      throw Error(
          "CentralDifference: safety must be in (0, 1], step and energy_growth not negative, and "
          "intervals at least 1");
  }

  /// The size of the last step, s.
  double step() const { return step_; }
  /// How often a stretch was rolled back and done again.
  int retries() const { return retries_; }

  /// Takes steps.
  template <class TheBody>
  void operator()(TheBody& body, int steps = 1) {
    long const goal = body.steps() + steps;
    while (body.steps() < goal) {
      if (body_ != &body || checked_nodes_ != body.nodes() || body.checkpoint_step() < 0)
        begin(body);
      if (body.steps() >= next_check_) check(body);
      if (body.steps() >= next_refresh_) refresh(body);
      body.step(step_,
                static_cast<int>(std::min({goal, next_check_, next_refresh_}) - body.steps()));
    }
  }

 private:
  /// A body, a mesh, or a state that was not seen before.
  template <class TheBody>
  void begin(TheBody& body) {
    if (std::exchange(body_, &body) != &body) slower_ = 1;
    checked_nodes_ = body.nodes();
    next_check_ = next_refresh_ = body.steps();
    energy_ = std::numeric_limits<double>::infinity();
  }

  template <class TheBody>
  void refresh(TheBody& body) {
    step_ = (options_.step > 0 ? options_.step : options_.safety * stable_step(body)) / slower_;
    next_refresh_ = body.steps() + options_.refresh_interval;
  }

  /// The energy that only time integration changes.
  template <class TheBody>
  static double energy_of(TheBody& body) {
    return body.total_energy() - adaptation_energy(body) - body.energy_of_new_loads();
  }

  template <class TheBody>
  void check(TheBody& body) {
    double const strain = body.strain_energy(), kinetic = body.kinetic_energy();
    double const energy = energy_of(body);
    bool const grew = !TheBody::has_internal_variables && !body.has_motions() &&
                      body.pressures().empty() &&
                      energy > energy_ + options_.energy_growth * (strain + kinetic);
    if (std::isfinite(energy) && !grew) {
      body.checkpoint();
      energy_ = energy;
      next_check_ = body.steps() + options_.check_interval;
      return;
    }
    std::string const what =
        detail::message({"CentralDifference: the body ", grew ? "gained energy" : "went non-finite",
                         " between steps ", body.checkpoint_step(), " and ", body.steps()});
    if (!body.restore())
      throw Error(what, ", and there is no earlier state of this mesh; start from a finite state");
    if (slower_ >= 8)
      throw Error(what, ", with an eighth of the step too (", step_, " s); it is now at time ",
                  body.time(),
                  " s, before that: look at its loads, and at laws that soften or cannot invert");
    energy_ = energy_of(body);  // loads may have changed since the checkpoint
    slower_ *= 2;
    ++retries_;
    next_check_ = body.steps() + options_.check_interval;
    next_refresh_ = body.steps();
  }

  CentralDifferenceOptions options_;
  double step_ = 0, slower_ = 1, energy_ = 0;
  long next_check_ = 0, next_refresh_ = 0;
  int retries_ = 0;
  void const* body_ = nullptr;
  Index checked_nodes_ = -1;
};

}  // namespace pliant
