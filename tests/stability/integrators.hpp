#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <pliant/solve.hpp>
#include <pliant/solver/local_steps.hpp>

#include "stability/scene.hpp"

// All that the suite knows of integrators.
namespace pliant::stability {

struct Progress {
  double step = 0;
  bool rolled_back = false;
  int retries = 0;
};

/// One of the integrators that advance a state, for as long as it keeps its step. All have lumped masses, in which the
/// suite measures.
class Stepper {
 public:
  /// `step`: s; 0 where the integrator chooses. Implicit ones have to be given one.
  Stepper(Method method, double safety, double step) : method_(method), step_(step) {
    if (method == Method::explicit_steps)
      central_.emplace(CentralDifferenceOptions{.safety = safety, .step = step});
    else if (method == Method::local_steps)
      local_.emplace(LocalStepsOptions{.safety = std::min(safety, 0.8), .macro_step = step});
    else if (method == Method::implicit_steps)
      implicit_.emplace(NewmarkOptions{.step = step, .mass = MassMatrix::lumped});
  }

  template <class TheBody>
  Progress operator()(TheBody& body, int steps) {
    if (central_) {
      auto const done = (*central_)(body, steps);
      return {done.step, done.rolled_back, central_->retries()};
    }
    if (local_) {
      auto const done = (*local_)(body, steps);
      return {done.step, done.rolled_back, local_->retries()};
    }
    (*implicit_)(body, steps);
    return {step_, false, 0};
  }

 private:
  Method method_;
  double step_;
  std::optional<CentralDifference> central_;
  std::optional<LocalSteps> local_;
  std::optional<Newmark> implicit_;
};

/// Static equilibrium.
template <class TheBody>
double solve_for_rest(TheBody& body, int load_steps) {
  return solve_static(body, {.load_steps = load_steps}).least_J.value;
}

}  // namespace pliant::stability
