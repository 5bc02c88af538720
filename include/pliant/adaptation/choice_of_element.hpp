#pragma once

#include <bit>
#include <limits>

#include <pliant/adaptation/choice.hpp>
#include <pliant/adaptation/sleep_of_element.hpp>
#include <pliant/body/criteria_workspace.hpp>
#include <pliant/body/step_schedule.hpp>

namespace pliant::detail {

/// A positive number rounded up to half of its digits: errors that are equal but for rounding, of mirrored elements or on
/// another backend, then count as equal, and their numbers decide.
template <class T>
PLIANT_HOST_DEVICE T rounded_up(T x) {
  using Bits = OrderedBits<T>;
  constexpr Bits rest = (Bits{1} << std::numeric_limits<T>::digits / 2) - 1;
  bool const rounds = T(0) < x && x < std::numeric_limits<T>::max() / 4;
  return rounds ? std::bit_cast<T>((std::bit_cast<Bits>(x) + rest) & static_cast<Bits>(~rest)) : x;
}

/// Where the groups of a choice stand, and what they cost.
template <int Groups, int Count>
struct ChoiceTable {
  static constexpr double units = 1 << 20;  // of cost, in that of the last group

  int place[Groups];          // of a group in the list; −1: not in it
  Tag group[Count];           // the inverse
  double cost[Count];         // in that of the last group, ascending
  std::int64_t whole[Count];  // in 1/units: sums of them depend on no order
};

/// A change that an element offers: to another place in the list, worth so many joules per evaluation.
template <class T>
struct Offer {
  int to = -1;  // −1: none
  T worth = T(0);
};

/// How an element of one of several groups chooses among them: alone, by a tolerance, or by what its changes are worth beside
/// those of others. Its offers, one after another, go along the lower convex hull of its points (cost, error), so that each
/// is worth less than the one before: all that are worth more than a limit are the best that all elements together
/// can do for what they cost (Lagrange; Sinha & Zoltners, The multiple-choice knapsack problem, 1979).
template <class T, int Groups, int Count>
struct ChoiceOfElement {
  ChoiceTable<Groups, Count> table;
  T const* errors;  // (count − 1, elements), J: beside the last group
  Index elements;
  Index const* number;  // (elements): in the order of which equal offers are taken
  Tag const* tags;
  std::int64_t const* since;  // (elements)
  std::int64_t const* step;   // (1): of this look
  SleepOfElement sleep;
  StepLevel const* levels;  // (patches), of local steps; null: one step serves all
  T tolerance, release;
  std::int64_t stay;
  bool waits;  // nothing may switch

  PLIANT_HOST_DEVICE int place_of(Index e) const {
    return tags[e] < Groups ? table.place[tags[e]] : -1;
  }
  PLIANT_HOST_DEVICE T error(Index e, int place) const {
    constexpr T most = std::numeric_limits<T>::max() / 4;  // infinite ones count as this
    return place + 1 == Count
               ? T(0)
               : min(errors[static_cast<std::ptrdiff_t>(elements) * place + e], most);
  }
  /// NaN counts as nothing.
  PLIANT_HOST_DEVICE T known_error(Index e, int place) const {
    T const own = error(e, place);
    return own == own ? own : T(0);
  }
  PLIANT_HOST_DEVICE bool sleeps(Index e) const { return sleep.sleeps(e); }
  /// How many forces of its own a step of the body takes: local steps evaluate a patch 2^level times.
  PLIANT_HOST_DEVICE std::int64_t updates(Index e) const {
    return std::int64_t{1} << (levels ? levels[sleep.patches.patch_of(e)] : 0);
  }
  PLIANT_HOST_DEVICE std::int64_t whole_cost(Index e, int place) const {
    return table.whole[place] * updates(e);
  }
  /// Whether it stays where it is in any case.
  PLIANT_HOST_DEVICE bool is_fixed(Index e) const {
    bool known = true;
    for (int k = 0; k < Count; ++k) known = known && error(e, k) == error(e, k);
    return waits || !known || sleeps(e);
  }
  PLIANT_HOST_DEVICE bool may_return(Index e) const { return *step - since[e] >= stay; }
  /// The cheapest place that it may go to.
  PLIANT_HOST_DEVICE int first_place(Index e, int present) const {
    return is_fixed(e) || !may_return(e) ? present : 0;
  }

  /// What it offers at a place.
  PLIANT_HOST_DEVICE Offer<T> offer(Index e, int from, int present) const {
    Offer<T> best;
    for (int k = from + 1; k < Count; ++k) {
      T const cost = static_cast<T>(table.cost[k] - table.cost[from]) * static_cast<T>(updates(e));
      T const worth = (error(e, from) - error(e, k)) / cost;
      if (best.worth < worth || (best.to >= 0 && worth == best.worth)) best = {k, worth};
    }
    if (best.to <= present) best.worth = best.worth / release;  // what it has already
    return best;
  }

  /// The place that it goes to by its tolerance.
  PLIANT_HOST_DEVICE int place_by_tolerance(Index e, int present) const {
    if (is_fixed(e)) return present;
    for (int k = may_return(e) ? 0 : present; k < Count; ++k)
      if (error(e, k) <= (k < present ? release * tolerance : tolerance)) return k;
    return Count - 1;
  }
  /// The place that it goes to if offers are taken down to a cut.
  PLIANT_HOST_DEVICE int place_by_cut(Index e, int present, Cut<T> const& cut) const {
    int at = first_place(e, present);
    if (is_fixed(e)) return at;
    for (;;) {
      auto const next = offer(e, at, present);
      if (next.to < 0 || !cut.holds(next.worth, number[e])) return at;
      at = next.to;
    }
  }
};

/// Finds the next groups of elements; 1 where one goes to another.
template <class Choice, class T>
struct Choose {
  Choice choice;
  Ranking<T> const* ranking;  // null: by the tolerance
  Tag* next;                  // (elements)

  PLIANT_HOST_DEVICE double operator()(Index e) const {
    int const present = choice.place_of(e);
    next[e] = choice.tags[e];
    if (present < 0) return 0;
    int const to = ranking ? choice.place_by_cut(e, present, ranking->cut)
                           : choice.place_by_tolerance(e, present);
    next[e] = choice.table.group[to];
    return to != present ? 1 : 0;
  }
};

}  // namespace pliant::detail
