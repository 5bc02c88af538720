#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/sums.hpp>
#include <pliant/body/ledger.hpp>
#include <pliant/body/set_state.hpp>

// Whether the state of a run is good: finite, and with the energy that it had and was given.
namespace pliant::detail {

/// How an integrator checks states, and the words for it.
struct EnergyCheck {
  char const* integrator;
  char const* step_name;  // what it counts: steps
  char const* cure;       // what to begin anew with
  double growth, drift;   // see CentralDifferenceOptions
  int interval;           // steps between checks
};

/// For how many steps a step stays shorter at the most.
inline constexpr std::int64_t most_steps_slower = std::int64_t{1} << 40;

/// The energy of a state less what was booked, J: in all, and what the integrator's steps keep; NaN where they
/// are not known.
struct CheckedEnergy {
  double total, kept;
};

/// Energies that rounding makes of a body that is at rest, J: of elements of Young's modulus that are turned.
template <class Parts>
double rounding_energy(Parts const& parts) {
  double const volume = parts.layout.mass_in_all / parts.material.density;
  return 64 * double{std::numeric_limits<typename Parts::T>::epsilon()} * parts.material.young *
         volume;
}

/// The next check has nothing to compare with.
inline void forget_energies(IntegratorState& own) {
  own.first_energy = own.last_energy = own.last_kept = std::numeric_limits<double>::quiet_NaN();
}

/// Whether the state is good, and is kept as a checkpoint; if not, it is rolled back, to be done again with half
/// the step, or an Error where that was tried thrice or there is no checkpoint. The integrator says the rest:
///   add_term(to)                                adds what it needs for that to *to in the backend's memory
///   energy(total, term, booked) -> CheckedEnergy  where the total energy, that and what is booked are these
///   explains(total, most) -> bool               whether growth of the total by `most` is none
///   step() -> double                            s, for the message
///   go_back()                                   to the checkpoint
///   set_slower(factor)                          how often the step is smaller than the stable one asks
/// After so many steps that were good a step that was chosen from the stable one is tried in full again: what made the
/// body unstable, a stiff law or an impact, may have gone. Each roll-back doubles their number, so that those which
/// fail cost little. One that was given is not tried again: nothing says that it is stable.
template <class Parts, class Steps>
bool check_energy(Parts& parts, EnergyCheck const& check, Steps& steps) {
  auto& state = parts.state;
  auto& own = state.integrator;
  constexpr std::size_t term = 3, work = 4, works = static_cast<std::size_t>(Work::count);
  Sums<work + works, typename Parts::backend_type> sums(parts.backend);
  add_energies(parts, sums.data());
  steps.add_term(sums.data() + term);
  copy_values(parts.backend, std::as_const(state.work).data(), sums.data() + work, works);
  auto const read = sums.read();
  double const present = read[0] + read[1], potential = read[2];
  double const least = std::max(present, rounding_energy(parts));
  auto const [total, kept] = steps.energy(present + potential, read[term],
                                          booked(parts, std::span(read).template last<works>()));
  bool const watched =
      !Parts::has_internal_variables && parts.driven.empty() && parts.pressures.empty();
  // An unstable step lets the total grow while what the steps keep stays; a state that stiffens faster than the
  // step follows adds to that too, or takes from it at once. Comparisons with NaN, before the first check, are false.
  double const drift = check.drift * std::max(own.scale, least);
  bool const grew =
      watched &&
      ((total > own.last_energy + check.growth * least && !steps.explains(check.growth * least)) ||
       kept > own.first_energy + drift);
  bool const fell = watched && kept < own.last_kept - drift;
  if (std::isfinite(total) && !grew && !fell) {
    own.scale = std::max(own.scale, present);
    own.last_energy = total;
    own.last_kept = kept;
    if (!std::isfinite(own.first_energy)) own.first_energy = kept;
    own.next_check = state.steps + check.interval;
    keep_checkpoint(parts);
    if (own.slower > 1 && own.asked_step == 0 && state.steps >= own.slow_until) {
      steps.set_slower(own.slower / 2);
      own.slow_until = state.steps + own.slow_for;
      own.next_refresh = state.steps;
    }
    return true;
  }
  std::string const what = message({check.integrator, ": the body ",
                                    !std::isfinite(total) ? "went non-finite"
                                    : grew                ? "gained energy"
                                                          : "lost energy",
                                    " before ", check.step_name, " ", state.steps});
  if (!parts.has_checkpoint)
    throw Error(what,
                ", and there is no earlier state to go back to since the mesh, a condition or the "
                "state was changed by hand; start from a finite state, with ",
                check.cure);
  double const slower = own.slower, step = steps.step();
  std::int64_t const slow_for = own.slow_for;
  steps.go_back();
  if (slower >= 8)
    throw Error(what, ", with an eighth of the step too (", step, " s); it is now at ",
                check.step_name, " ", state.steps, " and time ", state.time,
                " s, before that: look at its loads, and at laws that soften or cannot invert");
  steps.set_slower(2 * slower);
  own.slow_for = std::clamp<std::int64_t>(2 * slow_for, 4 * check.interval, most_steps_slower);
  own.slow_until = state.steps + own.slow_for;
  own.next_check = state.steps + check.interval;
  own.next_refresh = own.next_watch = state.steps;
  return false;
}

}  // namespace pliant::detail
