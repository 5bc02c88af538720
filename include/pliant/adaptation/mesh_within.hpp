#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include <pliant/adaptation/choice.hpp>
#include <pliant/topology/refinement_results.hpp>

// A mesh that is as fine as an error asks, or as a budget allows, wherever that is needed at the time, of elements in the
// groups that it takes.
namespace pliant {

struct MeshWithinOptions {
  static constexpr double none = std::numeric_limits<double>::infinity();

  double error =
      none;  // J: the sum of what is estimated of the elements, and of their discrepancies
  double evaluations_per_step = none;  // in forces of one element of the first formulation
  double milliseconds_per_step =
      none;  // measured from look to look, with all that a caller does between them
  double release =
      0.5;  // what is there is taken to be worth 1/release times as much where it is as elsewhere
  int max_level = 30;           // elements refined this often are left alone; at most most_levels
  double (*clock)() = nullptr;  // s; null: the machine's
};

/// Elements of the formulations Fs are refined and merged, raised and lowered, and go from one to another on the same element,
/// as an estimator and limits ask; see within.
template <class E, class... Fs>
struct MeshWithinRule {
  using from = std::tuple_element_t<0, std::tuple<Fs...>>;
  using formulations = detail::TypeList<Fs...>;
  /// Those on one element.
  template <class Other>
  using on = typename detail::FormulationsOf<Other, detail::TypeList<>, Fs...>::type;
  static constexpr bool holds_mesh = true;
  /// Whether some are on one element.
  static constexpr bool holds_groups = ((on<typename Fs::element>::size > 1) || ...);
  E estimator;
  MeshWithinOptions options;
};

namespace detail {
inline void check_limits(MeshWithinOptions const& options) {
  for (double limit : {options.error, options.evaluations_per_step, options.milliseconds_per_step})
    if (!(limit > 0)) throw Error("within: a limit is ", limit, "; give a positive number");
  if (!std::isfinite(options.error) && !std::isfinite(options.evaluations_per_step) &&
      !std::isfinite(options.milliseconds_per_step))
    throw Error(
        "within: there is no limit; give error, evaluations_per_step or milliseconds_per_step");
  if (!(options.release > 0 && options.release <= 1))
    throw Error("within: release is ", options.release, "; give a share above 0, 1 at the most");
  check_max_level("within", options.max_level);
}
template <class... Fs>
constexpr void check_choice_on(TypeList<Fs...>) {
  if constexpr (sizeof...(Fs) > 1) check_choice<Fs...>();
}
/// Formulations on one element of degree one, and behind them such on one of degree two on the same cell.
template <class First, class... Fs>
constexpr void check_held() {
  using Last = std::tuple_element_t<sizeof...(Fs), std::tuple<First, Fs...>>;
  using E = typename First::element;
  using Other = typename Last::element;
  static_assert(
      std::same_as<E, Other> || (E::degree == 1 && Other::degree == 2 &&
                                 std::same_as<typename E::cell, typename Other::cell>),
      "within(estimator, ...): formulations on one element, or on linear elements and behind "
      "them on quadratic ones of the same cell");
  constexpr std::array is_higher{false, (!std::same_as<typename Fs::element, E>)...};
  static_assert(
      std::ranges::is_sorted(is_higher) && ((std::same_as<typename Fs::element, E> ||
                                             std::same_as<typename Fs::element, Other>)&&...),
      "within(estimator, ...): formulations of at most two elements, those of one behind "
      "each other");
  using All = MeshWithinRule<void*, First, Fs...>;
  check_choice_on(typename All::template on<E>{});
  check_choice_on(typename All::template on<Other>{});
}
}  // namespace detail

/// Refines the elements of a formulation whose estimated error drops most per cost and merges the families whose error rises
/// least per cost saved, at each look anew: as few elements as keep what is estimated at most `error`, and never more than
/// `evaluations_per_step` or what `milliseconds_per_step` allow, which come first. Errors of smooth solutions are taken to fall
/// by 4^degree where an element is refined; at singular places that takes more looks. Towards an error a look makes no more
/// than leaves a quarter of what there is, and undoes only what is not wanted in the end. To keep levels within one, neighbours
/// are refined along, beyond the budget until the next look merges others.
///
/// Of several formulations on one element, from cheap to costly, each element takes the one for which its discrepancy from the
/// last (Discrepancy) and its cost are least, at the price at which elements are refined: one budget pays for laws and meshes.
/// Where a discrepancy is NaN an element keeps its group.
///
/// Behind formulations on linear elements there may be such on quadratic ones of the same cell: elements are refined or become
/// quadratic, and these are refined, merged or lowered: each takes the first step to the degree and the size for which its error
/// and its cost, at that price, are least. Raising is taken to make an error 16 times smaller, as one refinement of a
/// quadratic element does.
///
/// Elements that sleep cost nothing, and stay as they are. Throws Error for options out of range.
template <class... Fs, class E>
auto within(E estimator, MeshWithinOptions const& options) {
  static_assert(sizeof...(Fs) > 0 && (Estimator<E, Fs> && ...),
                "within<Fs...>(estimator, ...): an estimator of elements of each of Fs");
  detail::check_held<Fs...>();
  detail::check_limits(options);
  return MeshWithinRule<E, Fs...>{estimator, options};
}

}  // namespace pliant
