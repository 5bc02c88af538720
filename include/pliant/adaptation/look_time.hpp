#pragma once

#include <algorithm>
#include <limits>

#include <pliant/adaptation/choice.hpp>
#include <pliant/backend/host_timer.hpp>
#include <pliant/body/adaptation_record.hpp>
#include <pliant/body/looker.hpp>

// Budgets in milliseconds, as evaluations of forces. What else a step takes is measured with these: a share a of it leaves
// the budget missed by a factor that goes to 1 as aᵏ over k looks.
namespace pliant::detail {

template <class Rule>
double read_clock(Rule const& rule) {
  return rule.clock ? rule.clock() : HostTimer::now();
}

/// The budget of a rule, in evaluations per step; NaN: not known yet.
template <class Rule>
double budget_now(Rule const& rule, LastLook const& look) {
  if (!std::isfinite(rule.milliseconds_per_step)) return rule.evaluations_per_step;
  if (!(look.seconds_per_evaluation > 0)) return std::numeric_limits<double>::quiet_NaN();
  return std::min(rule.evaluations_per_step,
                  1e-3 * rule.milliseconds_per_step / look.seconds_per_evaluation);
}

/// Notes what an evaluation has taken since the look before, if that was the last one here: not in another process, nor
/// in a state that was rolled back or loaded since.
template <class Parts, class Rule>
void take_time(Parts const& parts, Rule const& rule, Looker const& looker, double evaluations,
               LastLook& look) {
  parts.backend.synchronize();
  double const now = read_clock(rule);
  auto const steps = static_cast<double>(parts.state.steps - look.timed);
  if (look.timed < 0 || looker.timed != look.timed || steps < 1) return;
  double const seconds = (now - looker.clock) / (steps * evaluations);
  if (!(seconds > 0) || !std::isfinite(seconds)) return;
  double& known = look.seconds_per_evaluation;
  known = known > 0 ? (known + seconds) / 2 : seconds;
}
/// Begins the next measurement.
template <class Parts, class Rule>
void start_time(Parts const& parts, Rule const& rule, Looker& looker, LastLook& look) {
  parts.backend.synchronize();
  looker.timed = look.timed = parts.state.steps;
  looker.clock = read_clock(rule);
}

}  // namespace pliant::detail
