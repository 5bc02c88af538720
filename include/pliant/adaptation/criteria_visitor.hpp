#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <tuple>

#include <pliant/adaptation/criterion_rows.hpp>
#include <pliant/adaptation/nodal_means.hpp>
#include <pliant/adaptation/rule_context.hpp>
#include <pliant/adaptation/young_at_rest.hpp>
#include <pliant/backend/kernel.hpp>

namespace pliant::detail {

/// Looks at the elements of a formulation, and does nothing.
template <class F, class C>
struct Look {
  using from = F;
  C criterion;
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
    constexpr std::array<int, count> values{values_of<decltype(Rules::criterion)>...};
    int most = 1;
    for (std::size_t i = 0; i < values.size(); ++i)
      most = std::max(most, layout.row[i] + values[i]);
    return most;
  }();

  std::tuple<Rules...> rules;

  using Places = Slots<Table, Rules...>;
  static constexpr bool reads_young = (ReadsYoung<decltype(Rules::criterion)> || ...);

  /// The criteria that look at group G, (rows), of an element that has changed group: what takes means is NaN.
  template <int G, class L, class V, class Around, class Own>
  PLIANT_HOST_DEVICE auto evaluate(L const& law, V const& rest, V const& u,
                                   typename Table::Laws const& groups, Around const& around,
                                   Own const& own) const {
    return evaluate<G>(law, rest, u, groups, around, own, NoElement{});
  }
  /// `found` are the values of criteria that take means, (slots).
  template <int G, class L, class V, class Around, class Own, class Found>
  PLIANT_HOST_DEVICE auto evaluate(L const& law, V const& rest, V const& u,
                                   typename Table::Laws const& groups, Around const& around,
                                   Own const& own, Found const& found) const {
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    Vector<S, rows> values{};
    auto const state = state_of<typename Table::template formulation<G>>(law, rest, u);
    evaluate_rules<G, 0>(state, groups, around, own, found, values);
    return values;
  }

  /// visit(GroupNumber<group>{}, GroupNumber<slot>{}, criterion) for each criterion that takes means, once.
  template <class Visit>
  void for_each_taker(Visit const& visit) const {
    std::array<bool, Places::count> visited{};
    [&]<int... R>(std::integer_sequence<int, R...>) {
      (takers_of_rule<R>(
           visit, visited,
           typename TakersOfMeans<decltype(rule<R>::criterion), typename rule<R>::from>::type{}),
       ...);
    }(std::make_integer_sequence<int, count>());
  }

 private:
  template <int R, class Visit, class... Cs>
  void takers_of_rule(Visit const& visit, std::array<bool, Places::count>& visited,
                      TypeList<Cs...>) const {
    (visit_taker<R, Cs>(visit, visited[Places::template slot<R, Cs>]), ...);
  }
  template <int R, class C, class Visit>
  void visit_taker(Visit const& visit, bool& visited) const {
    if (!visited)
      visit(GroupNumber<group<R>>{}, GroupNumber<Places::template slot<R, C>>{},
            *find_criterion<C>(std::get<R>(rules).criterion));
    visited = true;
  }
  template <int G, int R, class F, class L, class S, class Around, class Own, class Found>
  PLIANT_HOST_DEVICE void evaluate_rules(ElementState<F, L, S> const& state,
                                         typename Table::Laws const& groups, Around const& around,
                                         Own const& own, Found const& found,
                                         Vector<S, rows>& values) const {
    if constexpr (R < count) {
      if constexpr (group<R> == G && layout.first[R]) {
        using Context = RuleContext<Places, R, G, typename Table::Laws, Around, Own, Found>;
        Context const context{groups, around, own, found};
        auto const value =
            value_of(std::get<R>(rules).criterion, StateInBody<F, L, S, Context>{state, context});
        using C = decltype(rule<R>::criterion);
        if constexpr (GivesSeveral<C>)
          for (int k = 0; k < values_of<C>; ++k) values[row<R> + k] = value[k];
        else
          values[row<R>] = value;
      }
      evaluate_rules<G, R + 1>(state, groups, around, own, found, values);
    }
  }
};

/// Evaluates the criteria of rules, each once for each element that it looks at, and hands them over:
/// take(GroupNumber<G>{}, element, values, again, tally), where again() gives the fields at its nodes. Those behind
/// coordinates and displacements are for `take` alone.
template <class Table, class TheRules, class Around, class Take>
struct CriteriaVisitor {
  using T = typename Table::scalar;
  static constexpr int counters = Take::counters;
  static constexpr bool finishes_few = FinishesFew<Take>;
  static constexpr int slots = TheRules::Places::count;
  static constexpr bool reads_elements = Table::Laws::reads_elements || slots > 0;
  typename Table::Laws groups;
  TheRules rules;
  Around around;
  Take take;

  PLIANT_HOST_DEVICE bool selects(Index e, Tag group) const
    requires Selects<Take>
  {
    return take.selects(e, group);
  }
  template <int G, class V, std::same_as<V>... More>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const& rest, V const& u, More const&...) const
    requires(!reads_elements)
  {
    return at<G>(NoElement{}, rest, u);
  }
  template <int G, class Own, class V, std::same_as<V>... More>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, Own const& own, V const& rest, V const& u,
                                   More const&...) const
    requires reads_elements
  {
    return at<G>(own, rest, u);
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G> group, Index e,
                                 Vector<T, TheRules::rows> const& values, Again const& again,
                                 Tally const& tally) const {
    take(group, e, values, again, tally);
  }

 private:
  template <int G, class Own, class V>
  PLIANT_HOST_DEVICE auto at(Own const& own, V const& rest, V const& u) const {
    auto const& law = law_at<G>(own);
    if constexpr (Take::template bounded<G>) {
      using S = std::remove_cvref_t<decltype(rest(0, 0))>;
      auto const h = state_of<typename Table::template formulation<G>>(law, rest, u).gradient();
      if (!any_less(S(take.quiet_below(G)), dot(h, h))) {
        Vector<S, TheRules::rows> none;
        for (int k = 0; k < TheRules::rows; ++k) none[k] = S(std::numeric_limits<T>::lowest());
        return none;
      }
    }
    if constexpr (slots > 0)
      return rules.template evaluate<G>(
          law, rest, u, groups, around, own,
          own(ElementField<T const, slots>{around.found, around.elements}));
    else
      return rules.template evaluate<G>(law, rest, u, groups, around, own);
  }
  template <int G, class Own>
  PLIANT_HOST_DEVICE decltype(auto) law_at(Own const& own) const {
    if constexpr (Table::Laws::reads_elements)
      return groups.template law<G>(own);
    else
      return groups.template law<G>();
  }
};

template <class T, class Rules, class Parts, class Table>
auto surroundings(Parts const& parts, Table const& table,
                  CriteriaWorkspace<typename Parts::backend_type> const& w) {
  Surroundings<T, Parts::dim, Table::groups> around{};
  for (int k = 0; k < Parts::dim; ++k)
    around.origin[k] = static_cast<T>(parts.layout.middle[static_cast<std::size_t>(k)]);
  if constexpr (Rules::reads_young)
    [&]<class... Fs>(TypeList<Fs...>) {
      around.young = {{{static_cast<T>(
          young_at_rest(parts.template law_of<Fs>(), first_values<Fs>(parts)))}...}};
    }(typename Table::formulations{});
  around.found = w.found.data();
  around.elements = table.count();
  return around;
}

/// Evaluates the criteria of rules on the present state of a body, at some elements of a table. `fields` are what else
/// `take` reads at nodes.
template <class Parts, class Table, class Elements, class TheRules, class Take, class... Fields>
void evaluate_criteria(Parts const& parts, Table const& table,
                       ActiveElements<Elements> const& elements, TheRules const& rules,
                       CriteriaWorkspace<typename Parts::backend_type>& workspace, Take const& take,
                       typename Parts::template Array<double>& counters, Fields const&... fields) {
  using T = typename Parts::T;
  find_values_from_means(parts, table, rules, workspace);
  auto const around = surroundings<T, TheRules>(parts, table, workspace);
  parts.backend.template visit<Table::groups>(
      elements,
      CriteriaVisitor<Table, TheRules, std::remove_const_t<decltype(around)>, Take>{
          table.laws, rules, around, take},
      counters, parts.rest(), parts.u(), fields...);
}

}  // namespace pliant::detail
