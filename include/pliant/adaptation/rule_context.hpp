#pragma once

#include <pliant/adaptation/criterion/criterion.hpp>
#include <pliant/backend/backend.hpp>

namespace pliant::detail {

/// What criteria may look at besides elements, the same for all of them.
template <class T, int Dim, int Groups>
struct Surroundings {
  Vector<T, Dim> origin;     // m: positions at rest are relative to it
  Vector<T, Groups> young;   // Pa, of each group's law at rest; where a criterion reads it
  T const* found = nullptr;  // (slots, elements): values of criteria that take means
  Index elements = 0;
};

/// Gives nothing, where no kernel asks for values per element.
struct NoElement {};

/// What a rule's criterion sees around an element of group G.
template <class Slots, int R, int G, class Laws, class Around, class Own, class Found>
struct RuleContext {
  Laws const& groups;
  Around const& around;
  Own const& own;
  Found const& values;  // Vector<S, slots>; no slots: not known

  template <class To>
  PLIANT_HOST_DEVICE decltype(auto) law_of() const {
    constexpr int g = Slots::template group_of<To>;
    static_assert(g < std::tuple_size_v<decltype(Laws::laws)>,
                  "a criterion compares with a formulation of which the body has no Group");
    return groups.template law<g>(own);
  }
  PLIANT_HOST_DEVICE auto young() const { return around.young[G]; }
  template <class F>
  PLIANT_HOST_DEVICE auto young_of() const {
    return around.young[Slots::template group_of<F>];
  }
  PLIANT_HOST_DEVICE auto const& origin() const { return around.origin; }
  template <class C, class S>
  PLIANT_HOST_DEVICE S found() const {
    if constexpr (std::is_empty_v<Found>)
      return not_a_number<S>();
    else
      return values[Slots::template slot<R, C>];
  }
};

/// A criterion that takes means, of a rule.
template <class From, class C, int Rule>
struct Taker {
  using from = From;
  using criterion = C;
  static constexpr int rule = Rule;
};

template <int R, class From, class List>
struct TakersOfRule;
template <int R, class From, class... Cs>
struct TakersOfRule<R, From, TypeList<Cs...>> {
  static_assert(
      ((stateless<Cs> || times_in<Cs, TypeList<Cs...>> == 1) && ...),
      "a criterion that takes means and has data stands in one rule once; make two types of it");
  /// Rules share the values of equal criteria of one group.
  using type = TypeList<Taker<From, Cs, (stateless<Cs> ? -1 : R)>...>;
};

template <class Numbers, class... Rules>
struct TakersOfRules;
template <>
struct TakersOfRules<std::integer_sequence<int>> {
  using type = TypeList<>;
};
template <int R, int... Rs, class TheRule, class... Rules>
struct TakersOfRules<std::integer_sequence<int, R, Rs...>, TheRule, Rules...> {
  using from = typename TheRule::from;
  using own =
      typename TakersOfRule<R, from,
                            typename TakersOfMeans<decltype(TheRule::criterion), from>::type>::type;
  using type = typename Joined<
      own, typename TakersOfRules<std::integer_sequence<int, Rs...>, Rules...>::type>::type;
};

/// Where the values of criteria that take means stand, for the rules on one element type.
template <class Table, class... Rules>
struct Slots {
  template <int R>
  using rule = std::tuple_element_t<R, std::tuple<Rules...>>;
  using Takers =
      typename TakersOfRules<std::make_integer_sequence<int, sizeof...(Rules)>, Rules...>::type;
  static constexpr int count = Takers::size;
  template <class To>
  static constexpr int group_of = Table::template group_of<To>;
  /// Of the first of the equal ones.
  template <int R, class C>
  static constexpr int slot =
      position_in<Taker<typename rule<R>::from, C, (stateless<C> ? -1 : R)>>(Takers{});
};

}  // namespace pliant::detail
