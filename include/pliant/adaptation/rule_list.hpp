#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <tuple>

#include <pliant/adaptation/choice.hpp>
#include <pliant/adaptation/criteria_visitor.hpp>
#include <pliant/adaptation/mesh_within.hpp>
#include <pliant/adaptation/rule.hpp>
#include <pliant/adaptation/young_at_rest.hpp>
#include <pliant/solver/stiffening.hpp>

namespace pliant::detail {

/// The rules of an Adaptation, and what they can do together.
template <class... Rules>
struct RuleList {
  static constexpr bool chooses = (ChoosingRule<Rules> || ...);
  static constexpr bool holds_mesh = (HoldingRule<Rules> || ...);
  static constexpr bool switches =
      chooses || (SwitchingRule<Rules> || ...) || (HoldsGroups<Rules> || ...);
  static constexpr bool changes_mesh = holds_mesh || (MeshRule<Rules> || ...);
  static constexpr bool sleeps = (SleepingRule<Rules> || ...);
  static_assert((0 + ... + int{SleepingRule<Rules>}) <= 1,
                "an Adaptation has at most one rule that puts patches to sleep");
  static_assert((0 + ... + int{ChoosingRule<Rules>}) <= 1,
                "an Adaptation has at most one rule that chooses: one of cheapest and within");
  static_assert(
      !chooses || ((ChoosingRule<Rules> || SleepingRule<Rules>)&&...),
      "cheapest and within choose for all elements of their groups: rules that switch or change "
      "the mesh go into another Adaptation");

  static_assert(!holds_mesh || (((HoldingRule<Rules> || SleepingRule<Rules>)&&...) &&
                                (0 + ... + int{HoldingRule<Rules>}) == 1),
                "beside a rule that holds a mesh within limits an Adaptation has at most one that "
                "puts patches to sleep");

  std::tuple<Rules...> rules;

  template <class R>
  static constexpr bool takes_means_by() {
    if constexpr (SleepingRule<R> || ChoosingRule<R> || HoldingRule<R>)
      return false;
    else
      return !std::same_as<typename TakersOfMeans<decltype(R::criterion), typename R::from>::type,
                           TypeList<>>;
  }
  static constexpr bool takes_means = (takes_means_by<Rules>() || ...);
  template <class TheBody, class R>
  static constexpr bool one_acts_on() {
    if constexpr (SleepingRule<R>)
      return true;
    else if constexpr (ChoosingRule<R>)
      return TheBody::layout_type::template has<typename R::element>;
    else
      return TheBody::layout_type::template acts<typename R::from>;
  }

  /// Whether each rule is for an element type that a body's mesh has.
  template <class TheBody>
  static constexpr bool act_on = (one_acts_on<TheBody, Rules>() && ...);

  auto const& sleeping() const { return std::get<place_of({SleepingRule<Rules>...})>(rules); }
  auto const& holding() const { return std::get<place_of({HoldingRule<Rules>...})>(rules); }
  auto const& choosing() const { return std::get<place_of({ChoosingRule<Rules>...})>(rules); }
  bool limits_milliseconds() const {
    if constexpr (chooses)
      return std::isfinite(choosing().milliseconds_per_step);
    else if constexpr (holds_mesh)
      return std::isfinite(holding().options.milliseconds_per_step);
    else
      return false;
  }
  /// Whether rules go to a law that is stiffer at rest by more than the safety of the step covers.
  template <class Parts>
  bool may_stiffen(Parts const& parts) const {
    auto const allowance = step_allowance(parts);
    if (!allowance) return false;
    auto const is_stiffer = [&]<class... From, class... To>(TypeList<From...>, TypeList<To...>) {
      auto const young = [&]<class F>(TypeList<F>) {
        return young_at_rest(parts.template law_of<F>(), first_values<F>(parts));
      };
      return std::max({young(TypeList<To>{})...}) >
             allowance->growth * std::min({young(TypeList<From>{})...});
    };
    auto const stiffens = [&]<class R>(R const&) {
      if constexpr (SwitchingRule<R>)
        return is_stiffer(TypeList<typename R::from>{}, TypeList<typename R::to>{});
      else if constexpr (ChoosingRule<R>)
        return is_stiffer(typename R::groups{}, typename R::groups{});
      else if constexpr (HoldingRule<R>)
        return is_stiffer(typename R::formulations{}, typename R::formulations{});
      else
        return false;
    };
    return std::apply([&](auto const&... rule) { return (stiffens(rule) || ...); }, rules);
  }

 private:
  /// Of the first that holds.
  static constexpr std::size_t place_of(std::initializer_list<bool> holds) {
    return static_cast<std::size_t>(std::find(holds.begin(), holds.end(), true) - holds.begin());
  }
};

}  // namespace pliant::detail
