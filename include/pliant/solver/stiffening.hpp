#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <pliant/solver/distortion.hpp>
#include <pliant/solver/stable_step.hpp>

// Elements that a switch makes stiffer: the step that was chosen for the others may be too long for them.
namespace pliant {

/// What the chosen step allows elements that change their law.
struct StepAllowance {
  double squared_frequency;  // 1/s²: the ω² that it was chosen for
  double growth;             // times this, and times an element's own: what its safety covers
};

/// Of the step that an integrator has chosen for all elements; none while it has chosen none, was given one, or has
/// one for each element.
template <class Parts>
std::optional<StepAllowance> step_allowance(Parts const& parts) {
  auto const& own = parts.state.integrator;
  if (!own.active || own.macro_step > 0 || own.asked_step > 0 || !(own.step > 0)) return {};
  double const frequency = 2 * own.safety / (own.step * own.slower);
  return StepAllowance{square(frequency), 1 + std::clamp(1 / square(own.safety) - 1, 0.0, 0.1)};
}

namespace detail {

/// Bounds ω² of the elements whose next group is another.
template <class T, class Laws>
struct SpectraOfMovers : ElementSpectra<T, Laws> {
  Tag const* next;
  PLIANT_HOST_DEVICE bool selects(Index e, Tag group) const { return next[e] != group; }
};

/// Counts those that moved at a step and are now stiffer than before, and than the step allows. NaN counts.
template <class T, class Laws>
struct CountStiffened : ElementSpectra<T, Laws> {
  static constexpr int counters = static_cast<int>(Work::count);
  std::int64_t const *since, *step;
  T most, growth;

  PLIANT_HOST_DEVICE bool selects(Index e, Tag) const { return since[e] == *step; }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const& value, Again const&,
                                 Tally const& tally) const {
    if (!selects(e, 0)) return;
    if (!(value[0] <= most) && !(value[0] <= growth * this->bound[e]))
      tally(static_cast<int>(Work::stiffened), 1.0);
  }
};

template <class Parts, class Table>
ElementSpectra<typename Parts::T, typename Table::Laws> spectra_of(Parts& parts, Table& table) {
  using T = typename Parts::T;
  return {table.laws, static_cast<T>(parts.material.density), table.scratch.data()};
}

/// Leaves bounds of ω² of those of some elements that are about to change groups in their table's scratch, which has
/// room.
template <class Parts, class Table, class Elements>
void bound_movers(Parts& parts, Table& table, ActiveElements<Elements> const& elements,
                  Tag const* next) {
  using Visitor = SpectraOfMovers<typename Parts::T, typename Table::Laws>;
  parts.backend.template visit<Table::groups>(elements, Visitor{spectra_of(parts, table), next},
                                              parts.no_counters, parts.rest(),
                                              std::as_const(parts).u());
}
/// Counts those that are stiffer than before and than the step allows, once they moved. `since`: (elements), the
/// steps at which they last did; `step`: (1), the present one.
template <class Parts, class Table, class Elements>
void count_stiffened(Parts& parts, Table& table, ActiveElements<Elements> const& elements,
                     StepAllowance const& allowance, std::int64_t const* since,
                     std::int64_t const* step) {
  using T = typename Parts::T;
  parts.backend.template visit<Table::groups>(
      elements,
      CountStiffened<T, typename Table::Laws>{
          spectra_of(parts, table), since, step,
          static_cast<T>(allowance.growth * allowance.squared_frequency),
          static_cast<T>(allowance.growth)},
      parts.state.work, parts.rest(), std::as_const(parts).u());
}

/// Whether elements of a body may change groups.
template <class Parts>
bool can_switch(Parts const& parts) {
  bool can = false;
  parts.for_each_type([&](auto const& table, auto const&) {
    can = can || std::remove_cvref_t<decltype(table)>::groups > 1;
  });
  return can;
}

}  // namespace detail

/// Whether switches have made elements stiffer than the step allows since it was chosen.
template <class Parts>
bool is_stiffened(Parts const& parts) {
  return detail::can_switch(parts) &&
         parts.backend.sum(1, detail::ValueAt<double>{parts.state.work.data() +
                                                      static_cast<int>(Work::stiffened)}) > 0;
}
/// Whether elements are distorted more or less than when the step was chosen, by a tenth, or stiffer.
template <class Parts>
bool asks_for_step(Parts& parts) {
  double const then = parts.state.integrator.distortion;
  return !(std::abs(largest_distortion(parts) - then) <= 0.1 * (1 + then)) || is_stiffened(parts);
}
/// Begins to count anew: the step is chosen for the present elements.
template <class Parts>
void forget_stiffened(Parts& parts) {
  if (detail::can_switch(parts))
    parts.backend.for_each(
        1, detail::FillValue<double>{parts.state.work.data() + static_cast<int>(Work::stiffened),
                                     0.0});
}

/// Lets the integrator choose its step anew before the next one, where a switch asks for that. Steps of elements are
/// chosen anew by any.
template <class Parts>
void follow_switch(Parts& parts) {
  auto& own = parts.state.integrator;
  if (own.active && (own.macro_step > 0 || is_stiffened(parts)))
    own.next_refresh = parts.state.steps;
}

}  // namespace pliant
