#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <pliant/solver/stable_step.hpp>

namespace pliant {

struct CentralDifferenceOptions {
  double safety = 0.9;          // times the guaranteed stable step
  double step = 0;              // s; 0: from stable_step
  int check_interval = 256;     // steps between checks of finiteness and energy
  int refresh_interval = 1024;  // steps between evaluations of the stable step
  /// Growth of the total energy between checks, over strain and kinetic energy, that counts as a
  /// blow-up. Not looked at while nodes are driven, who do work.
  double energy_growth = 0.1;
};

/// Explicit time integration by central differences (leapfrog, velocity Verlet), with lumped masses
/// and centred mass damping. Checks the state at intervals: one that went non-finite or gained energy
/// is rolled back to the last check and done again with half the step; after three halvings it
/// throws Error and leaves the body at the last good state.
template <class TheBody>
class CentralDifferenceRun;

class CentralDifference {
 public:
  explicit CentralDifference(CentralDifferenceOptions options = {}) : options_(options) {
    if (!(options.safety > 0 && options.safety <= 1) || !(options.step >= 0) ||
        options.check_interval < 1 || options.refresh_interval < 1)
      throw Error(
          "CentralDifference: safety must be in (0, 1], step not negative, and intervals at least "
          "1");
  }

  /// The step that was taken last, s.
  double step() const { return step_; }
  /// How often a stretch was rolled back and done again.
  int retries() const { return retries_; }

  /// Takes steps.
  template <class TheBody>
  void operator()(TheBody& body, int steps = 1) {
    for (int k = 0; k < steps; ++k) one(body);
  }
  /// Asks for a new stable step, after a change that the integrator cannot see.
  void refresh() { until_refresh_ = 0; }

 private:
  template <class TheBody>
  void one(TheBody& body) {
    if (until_refresh_ <= 0 || seen_nodes_ != body.nodes()) {
      step_ = (options_.step > 0 ? options_.step : options_.safety * stable_step(body)) / slower_;
      until_refresh_ = options_.refresh_interval;
      seen_nodes_ = body.nodes();
    }
    body.evaluate_forces();
    body.advance(body.owed(), step_ / 2, step_);
    body.owe(step_ / 2);
    body.tick(step_, 1);
    if (body.has_motions()) body.prescribe(body.time(), step_);
    --until_refresh_;
  }

  CentralDifferenceOptions options_;
  double step_ = 0, slower_ = 1;
  int until_refresh_ = 0, retries_ = 0;
  Index seen_nodes_ = -1;
};

}  // namespace pliant
