#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <pliant/adaptation/rule.hpp>
#include <pliant/body/group_laws.hpp>
#include <pliant/error.hpp>

// Strategies that choose among several groups at once, listed from cheap to costly; the last one is the reference,
// which errors are told beside (Discrepancy):
//   cheapest<Linear, Turning, Rubber>({.tolerance = 1e-6})
//   within<Linear, Rubber>({.error = 1e-3})
//   within<Linear, Turning, Rubber>({.evaluations_per_step = 5e3, .stay = 200})
namespace pliant {

struct CheapestOptions {
  double tolerance;       // J: of each element
  double release = 0.25;  // an element returns to a cheaper group below this share of the tolerance
  std::int64_t stay =
      0;  // steps that an element stays in a group before it returns to a cheaper one
};

/// For a list of so many groups. At least one limit; of several, the strictest holds.
template <int Groups>
struct WithinOptions {
  static constexpr double none = std::numeric_limits<double>::infinity();

  double error = none;                 // J: the sum over the elements
  double evaluations_per_step = none;  // in forces of one element in the last group
  double milliseconds_per_step =
      none;  // measured from look to look, with all that a caller does between them
  double release =
      0.5;  // elements are taken to be worth 1/release times as much where they are as elsewhere
  std::int64_t stay =
      0;  // steps that an element stays in a group before it returns to a cheaper one
  /// Of one element's force in each group, ascending, in any unit; see measure_costs. Left out: counted operations,
  /// the same on all machines.
  std::array<double, std::size_t{Groups}> costs{};
  double (*clock)() = nullptr;  // s; null: the machine's
};

/// Each element of one of the groups Fs goes to the cheapest of them whose discrepancy is below `tolerance`; or,
/// limits for the sum of all, elements whose error drops most per cost go to a costlier one. Elements where a discrepancy
/// is NaN, and those that sleep, stay where they are, as do those under whose deformation the law they would go to is not
/// strongly elliptic (is_strongly_elliptic); elements in other groups are passed over.
template <class... Fs>
struct ChoiceRule {
  using groups = detail::TypeList<Fs...>;
  using element = typename std::tuple_element_t<0, std::tuple<Fs...>>::element;
  static constexpr int count = sizeof...(Fs);

  double tolerance;  // J per element; infinite where sums are limited
  double error, evaluations_per_step, milliseconds_per_step;
  double release;
  std::int64_t stay;
  std::array<double, sizeof...(Fs)> costs;  // 0: counted
  double (*clock)();

  /// Whether elements are compared with each other.
  bool limits_sums() const { return !std::isfinite(tolerance); }
  bool gives_costs() const { return costs[0] > 0; }
};

namespace detail {
template <class... Fs>
constexpr void check_choice() {
  using First = std::tuple_element_t<0, std::tuple<Fs...>>;
  static_assert(sizeof...(Fs) >= 2,
                "a choice is among two groups or more: cheapest<Cheap, Costly>(...)");
  static_assert((std::same_as<typename Fs::element, typename First::element> && ...),
                "a choice is among formulations on one element");
  static_assert(((times_in<Fs, TypeList<Fs...>> == 1) && ...), "a choice names each group once");
  static_assert(((internal_variables_of<Fs> == internal_variables_of<First> &&
                  (internal_variables_of<Fs> == 0 ||
                   std::same_as<typename Fs::quadrature, typename First::quadrature>)) &&
                 ...),
                "a choice is among groups with the same internal variables, or none: the "
                "discrepancy to a group "
                "whose internal variables an element has not kept is not known");
}
inline void check_hysteresis(char const* what, double release, std::int64_t stay) {
  if (!(release > 0 && release <= 1))
    throw Error(what, ": release is ", release, "; give a share above 0, 1 at the most");
  if (stay < 0) throw Error(what, ": stay is ", stay, " steps; give at least 0");
}
template <std::size_t N>
void check_costs(std::array<double, N> const& costs) {
  if (std::ranges::all_of(costs, [](double c) { return c == 0; })) return;
  for (std::size_t k = 0; k < N; ++k)
    if (!std::isfinite(costs[k]) || !(costs[k] > (k == 0 ? 0 : costs[k - 1])))
      throw Error("within: the cost of group ", k, " is ", costs[k],
                  "; give positive numbers, ascending: list groups from cheap to costly");
}
}  // namespace detail

/// Each element goes to the cheapest of the groups Fs, listed from cheap to costly, whose discrepancy from the last
/// one is at most `tolerance`; back to a cheaper one where it is at most `release` times that, after `stay` steps. The
/// last group has none, so that the tolerance can be met everywhere. A look evaluates the stresses of all groups of the
/// list at each element, which takes about as long as their forces: look seldom where the last law is costly
/// (Adaptation::every). Throws Error for options out of range.
template <class... Fs>
auto cheapest(CheapestOptions const& options) {
  detail::check_choice<Fs...>();
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance))
    throw Error("cheapest: tolerance is ", options.tolerance, " J; give a positive energy");
  detail::check_hysteresis("cheapest", options.release, options.stay);
  constexpr double none = WithinOptions<2>::none;
  return ChoiceRule<Fs...>{options.tolerance, none,         none, none,
                           options.release,   options.stay, {},   nullptr};
}

/// Spends on the elements whose estimated error drops most per cost, and gives back where there is room, at each look
/// anew: as few costly elements as keep the sum of all discrepancies from the last group at most `error`, and never more
/// than cost `evaluations_per_step` or `milliseconds_per_step`. What even the cheapest groups cost, and what elements
/// that must stay cost, is spent whatever the budget. A budget in milliseconds follows what steps took since the look
/// before: half of the newest, half of before, in the saved state; before something is measured nothing switches. Such
/// runs do not repeat to the bit; the others do, where the backend does. Under LocalSteps a step is a macro step,
/// and a force of an element counts as often as its level is evaluated in one; levels follow from stability and are no
/// choice of accuracy: they weigh what is chosen, and nothing spends on them. Looks cost as those of `cheapest`, and some passes
/// over the values found. Throws Error for options out of range.
template <class... Fs>
auto within(WithinOptions<int{sizeof...(Fs)}> const& options) {
  detail::check_choice<Fs...>();
  auto const check = [](char const* what, double limit, char const* unit) {
    if (!(limit > 0))
      throw Error("within: ", what, " is ", limit, "; give a positive number", unit,
                  ", or leave it out");
  };
  check("error", options.error, " of joules");
  check("evaluations_per_step", options.evaluations_per_step, " of forces of one element");
  check("milliseconds_per_step", options.milliseconds_per_step, "");
  if (!std::isfinite(
          std::min({options.error, options.evaluations_per_step, options.milliseconds_per_step})))
    throw Error(
        "within: there is no limit; give error, evaluations_per_step or "
        "milliseconds_per_step");
  detail::check_hysteresis("within", options.release, options.stay);
  detail::check_costs(options.costs);
  return ChoiceRule<Fs...>{WithinOptions<2>::none,
                           options.error,
                           options.evaluations_per_step,
                           options.milliseconds_per_step,
                           options.release,
                           options.stay,
                           options.costs,
                           options.clock};
}

}  // namespace pliant
