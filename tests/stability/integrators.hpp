#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <pliant/solve.hpp>
#include <pliant/solver/local_steps.hpp>

#include "stability/scene.hpp"

// All that the suite knows of integrators.
namespace pliant::stability {

/// The trapezoidal rule or backward Euler, chosen while the program runs: bodies compile one scheme.
struct ChosenScheme {
  bool is_euler = false;
  static constexpr int order = 2;
  static constexpr bool looks_back = false;
  static constexpr char const* name = "Implicit";
  void check() const {}
  StepRule rule(double h, double h_before) const {
    return is_euler ? BackwardEuler{}.rule(h, h_before) : Newmark{}.rule(h, h_before);
  }
};

struct Progress {
  double step = 0;
  bool rolled_back = false;
  int retries = 0;
  double error = 0;   // m: by how much displacements may be off, as the integrator tells
  bool lost = false;  // it tells that this is not known
};

/// One of the integrators that advance a state, for as long as it keeps its step. All have lumped masses, in which the
/// suite measures.
class Stepper {
 public:
  /// `step`: s; 0 where the integrator chooses. Implicit ones have to be given one. A reference may fold, and is not asked for
  /// its errors.
  Stepper(Method method, double safety, double step, bool is_reference = false)
      : method_(method), step_(step) {
    if (method == Method::explicit_steps)
      central_.emplace(CentralDifferenceOptions{.safety = safety, .step = step});
    else if (method == Method::local_steps)
      local_.emplace(LocalStepsOptions{.safety = std::min(safety, 0.8), .macro_step = step});
    else if (method != Method::statics)
      implicit_.emplace(
          ChosenScheme{method == Method::backward_euler},
          ImplicitOptions{.step = step,
                          .mass = MassMatrix::lumped,
                          .errors = is_reference ? ErrorEstimate::added_up : ErrorEstimate::carried,
                          .accept_folded = is_reference});
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
    auto const done = (*implicit_)(body, steps);
    return {.step = step_, .error = done.error_in_all, .lost = done.errors_lost};
  }
  /// Whether the present state is good; explicit integrators look at it only now, and go back where it is not.
  template <class TheBody>
  bool check(TheBody& body) {
    if (central_) return !central_->check(body).rolled_back;
    if (local_) return !local_->check(body).rolled_back;
    return true;
  }

 private:
  Method method_;
  double step_;
  std::optional<CentralDifference> central_;
  std::optional<LocalSteps> local_;
  std::optional<Implicit<ChosenScheme>> implicit_;
};

/// Static equilibrium. A saddle, which the report tells of, counts as told.
template <class TheBody>
double solve_for_rest(TheBody& body, int load_steps) {
  auto const report = solve_static(body, {.load_steps = load_steps});
  if (report.indefinite)
    throw Error("suite: the report of solve_static tells of a saddle; take other load steps");
  return report.least_J.value;
}

}  // namespace pliant::stability
