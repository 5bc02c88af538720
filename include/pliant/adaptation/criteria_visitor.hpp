#pragma once

#include <algorithm>
#include <array>
#include <tuple>

#include <pliant/adaptation/criterion/criterion.hpp>
#include <pliant/backend/backend.hpp>

namespace pliant::detail {

/// The row of the value of each rule's criterion. Rules on different groups share rows, as do rules on
/// one group whose criteria are the same.
template <class Table, class... Rules>
struct CriterionRows {
  static constexpr std::size_t count = sizeof...(Rules);

  template <class A, class B>
  static constexpr bool same_value = std::same_as<typename A::from, typename B::from> &&
                                     std::same_as<decltype(A::criterion), decltype(B::criterion)> &&
                                     stateless<decltype(A::criterion)>;
  template <class A>
  static constexpr std::array<bool, count> same_values{same_value<A, Rules>...};

  std::array<int, count> row{};
  std::array<bool, count> first{};  // of the rules with the same value

  static constexpr CriterionRows make() {
    CriterionRows r;
    std::array<int, count> const group{Table::template group_of<typename Rules::from>...};
    std::array<std::array<bool, count>, count> const same{same_values<Rules>...};
    for (std::size_t i = 0; i < count; ++i) {
      r.first[i] = true;
      for (std::size_t j = 0; j < i; ++j)
        if (r.first[i] && same[i][j]) {
          r.first[i] = false;
          r.row[i] = r.row[j];
        }
      if (r.first[i])
        for (std::size_t j = 0; j < i; ++j) r.row[i] += group[j] == group[i] && r.first[j] ? 1 : 0;
    }
    return r;
  }
};

/// The rules that look at one element type, in their order. A rule has a type `from` and a member
/// `criterion`.
template <class Table, class... Rules>
struct TableRules {
  static constexpr int count = sizeof...(Rules);
  template <int R>
  using rule = std::tuple_element_t<R, std::tuple<Rules...>>;
  template <int R>
  static constexpr int group = Table::template group_of<typename rule<R>::from>;
  static_assert(((Table::template group_of<typename Rules::from> < Table::groups) && ...),
                "a rule names a formulation of which the body has no Group");

  static constexpr auto layout = CriterionRows<Table, Rules...>::make();
  template <int R>
  static constexpr int row = layout.row[R];
  static constexpr int rows = [] {
    int most = 1;
    for (int row : layout.row) most = std::max(most, row + 1);
    return most;
  }();

  std::tuple<Rules...> rules;

  /// The criteria that look at group G, (rows).
  template <int G, class L, class V>
  PLIANT_HOST_DEVICE auto evaluate(L const& law, V const& rest, V const& u) const {
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    Vector<S, rows> values{};
    auto const state = state_of<typename Table::template formulation<G>>(law, rest, u);
    evaluate_rules<G, 0>(state, values);
    return values;
  }

 private:
  template <int G, int R, class State, class Values>
  PLIANT_HOST_DEVICE void evaluate_rules(State const& state, Values& values) const {
    if constexpr (R < count) {
      if constexpr (group<R> == G && layout.first[R])
        values[row<R>] = std::get<R>(rules).criterion(state);
      evaluate_rules<G, R + 1>(state, values);
    }
  }
};

/// Evaluates the criteria of rules, each once for each element that it looks at, and hands them over:
/// take(GroupNumber<G>{}, element, values, tally).
template <class Table, class TheRules, class Take>
struct CriteriaVisitor {
  using T = typename Table::scalar;
  static constexpr int counters = Take::counters;
  static constexpr bool reads_elements = Table::Laws::reads_elements;
  typename Table::Laws groups;
  TheRules rules;
  Take take;

  template <int G, class... V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const&... v) const {
    return groups.template apply<G>(
        [this](auto const& law, auto const& rest, auto const& u)
            PLIANT_INLINE { return rules.template evaluate<G>(law, rest, u); },
        v...);
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G> group, Index e,
                                 Vector<T, TheRules::rows> const& values, Again const&,
                                 Tally const& tally) const {
    take(group, e, values, tally);
  }
};

/// Evaluates the criteria of rules on the present state of a body.
template <class Parts, class Table, class TheRules, class Take>
void evaluate_criteria(Parts const& parts, Table const& table, TheRules const& rules,
                       Take const& take, typename Parts::template Array<double>& counters) {
  parts.backend.template visit<Table::groups>(
      table.elements, CriteriaVisitor<Table, TheRules, Take>{table.laws, rules, take}, counters,
      parts.rest(), parts.u());
}

}  // namespace pliant::detail
