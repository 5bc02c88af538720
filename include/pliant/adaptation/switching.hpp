#pragma once

#include <array>
#include <tuple>

#include <pliant/adaptation/criterion/element_state.hpp>
#include <pliant/adaptation/strategy.hpp>
#include <pliant/body/velocities.hpp>

namespace pliant::detail {

template <class Rule>
concept Switches = requires { typename Rule::to; };
template <class Rule, class Table>
concept On = std::same_as<typename Rule::from::element, typename Table::element>;

/// The criterion of one rule, for every element that it looks at.
template <class Table, class Rule>
struct RankVisitor {
  using T = typename Table::scalar;
  using Laws = typename Table::Laws;
  static constexpr int counters = 1;
  static constexpr bool reads_elements = Laws::reads_elements;
  Laws groups;
  Rule rule;
  T* values;  // (elements)

  template <int G>
  static constexpr bool looks_at =
      std::same_as<typename Table::template formulation<G>, typename Rule::from>;

  template <int G, class... V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const&... v) const {
    return groups.template apply<G>(
        [this](auto const& law, auto const& rest, auto const& u) PLIANT_INLINE {
          Vector<std::remove_cvref_t<decltype(rest(0, 0))>, 1> value{};
          if constexpr (looks_at<G>)
            value[0] = rule.criterion(state_of<typename Rule::from>(law, rest, u));
          return value;
        },
        v...);
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const& value, Again const&,
                                 Tally const&) const {
    values[e] = looks_at<G> ? value[0] : std::numeric_limits<T>::quiet_NaN();
  }
};

/// One pass over a table: evaluates the criteria of the rules that look at each element's group, and
/// lets the first rule that holds act: the tag changes, the statistics are updated.
template <class Table, class... Rules>
struct SwitchVisitor {
  using T = typename Table::scalar;
  using Laws = typename Table::Laws;
  using Counters = CounterLayout<Table::groups>;
  static constexpr int counters = Counters::count;
  static constexpr bool reads_elements = Laws::reads_elements;
  static constexpr int rule_count = sizeof...(Rules);

  Laws groups;
  std::tuple<Rules...> rules;
  T threshold[rule_count];
  Tag* tags;
  Index* since;
  std::uint16_t* switches;
  Index step;
  T owed;  // s: the half kick that the last step left open

  template <int R>
  using rule = std::tuple_element_t<R, std::tuple<Rules...>>;
  template <int G, int R>
  static constexpr bool looks_at =
      std::same_as<typename Table::template formulation<G>, typename rule<R>::from>;

  template <int G, class... V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const&... v) const {
    return groups.template apply<G>(
        [this](auto const& law, auto const& rest, auto const& u, auto const&) PLIANT_INLINE {
          Vector<std::remove_cvref_t<decltype(rest(0, 0))>, rule_count> values{};
          evaluate_rules<G, 0>(law, rest, u, values);
          return values;
        },
        v...);
  }

  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, rule_count> const& values,
                                 Again const& again, Tally const& tally) const {
    act<G, 0>(e, values, again, tally);
  }

 private:
  template <int G, int R, class L, class V, class Values>
  PLIANT_HOST_DEVICE void evaluate_rules(L const& law, V const& rest, V const& u,
                                         Values& values) const {
    if constexpr (R < rule_count) {
      if constexpr (looks_at<G, R>)
        values[R] = std::get<R>(rules).criterion(
            state_of<typename Table::template formulation<G>>(law, rest, u));
      evaluate_rules<G, R + 1>(law, rest, u, values);
    }
  }

  template <int G, int R, class Again, class Tally>
  PLIANT_HOST_DEVICE void act(Index e, Vector<T, rule_count> const& values, Again const& again,
                              Tally const& tally) const {
    if constexpr (R < rule_count) {
      if constexpr (looks_at<G, R>) {
        auto const& r = std::get<R>(rules);
        bool const holds = r.marking.kind == MarkingKind::below ? values[R] < threshold[R]
                                                                : values[R] > threshold[R];
        if (holds && step - since[e] >= r.stay) {
          move<G, Table::template group_of<typename rule<R>::to>>(e, again, tally);
          return;
        }
      }
      act<G, R + 1>(e, values, again, tally);
    }
  }

  /// Seldom called, so kept out of line; constexpr is what lets device code call it. The half kick that
  /// is still owed will be given under the new law, which changes the kinetic energy by the
  /// difference of the forces times velocity, to first order in the step.
  template <int From, int To, class Again, class Tally>
  [[gnu::noinline]] constexpr void move(Index e, Again const& again, Tally const& tally) const {
    using Old = typename Table::template formulation<From>;
    using New = typename Table::template formulation<To>;
    OneElement const own{e};
    auto const old_law = groups.template law<From>(own);
    auto const new_law = groups.template law<To>(own);
    auto const [rest, u, v] = again();
    T const before = energy<Old>(old_law, rest, u);
    auto const pull_before = force<Old>(old_law, rest, u);
    carry_internal_variables<From, To>(groups, e, rest, u);
    T const after = energy<New>(new_law, rest, u);
    auto const difference = force<New>(new_law, rest, u) - pull_before;
    tally(Counters::kinetic(From, To), static_cast<double>(owed * dot(difference, v)));
    tally(Counters::steps_of(From), static_cast<double>(step - since[e]));
    tally(Counters::moves(From, To), 1.0);
    tally(Counters::energy(From, To), static_cast<double>(after - before));
    tags[e] = static_cast<Tag>(To);
    since[e] = step;
    switches[e] = static_cast<std::uint16_t>(switches[e] + 1);
  }
};

/// The rules of a list that switch, on this table.
template <class Table, class Rule>
auto only_switching(Rule const& rule) {
  if constexpr (Switches<Rule> && On<Rule, Table>) {
    static_assert(Table::template group_of<typename Rule::from> < Table::groups &&
                      Table::template group_of<typename Rule::to> < Table::groups,
                  "a rule names a formulation of which the body has no Group");
    return std::tuple<Rule>{rule};
  } else {
    return std::tuple<>{};
  }
}

/// Values of a rule's criterion in the backend's memory, NaN where it does not look.
template <class Parts, class Table, class Rule>
auto criterion_values(Parts& parts, Table& table, Rule const& rule) {
  auto values = zeros<typename Parts::T>(parts.backend, static_cast<std::size_t>(table.count()));
  parts.backend.template visit<Table::groups>(
      table.elements, RankVisitor<Table, Rule>{table.laws, rule, values.data()}, parts.no_counters,
      parts.rest(), std::as_const(parts).u());
  return values;
}

/// Lets the switching rules act on one table, once.
template <class Parts, class Table, class Elements, class... Rules>
void switch_groups(Parts& parts, Table& table, Elements& elements,
                   std::tuple<Rules...> const& rules) {
  if constexpr (sizeof...(Rules) > 0) {
    using T = typename Parts::T;
    auto& statistics = elements.statistics;
    if (!statistics.open) statistics.start(parts.backend, table.count(), parts.state.record.born);
    SwitchVisitor<Table, Rules...> visitor{table.laws,
                                           rules,
                                           {},
                                           elements.tags.data(),
                                           statistics.since.data(),
                                           statistics.switches.data(),
                                           static_cast<Index>(parts.state.steps),
                                           static_cast<T>(parts.state.pending_half_kick)};
    int r = 0;
    std::apply(
        [&](auto const&... rule) {
          ((visitor.threshold[r++] =
                rule.marking.ranks()
                    ? threshold_of(rule.marking, parts.backend,
                                   criterion_values(parts, table, rule).data(), table.count())
                : rule.marking.below()
                    ? static_cast<T>(rule.marking.amount)
                    : static_cast<T>(std::max(rule.marking.amount, rule.marking.floor))),
           ...);
        },
        rules);
    parts.backend.template visit<Table::groups>(table.elements, visitor, statistics.counters,
                                                parts.rest(), std::as_const(parts).u(),
                                                std::as_const(parts).v());
  }
}

}  // namespace pliant::detail
