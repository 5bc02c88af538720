#pragma once

#include <pliant/adaptation/criteria_visitor.hpp>
#include <pliant/adaptation/rule.hpp>
#include <pliant/backend/dispatch.hpp>
#include <pliant/body/criteria_workspace.hpp>

namespace pliant::detail {

/// Finds what each element does next, from the values of its criteria.
template <class Table, class... Rules>
struct Decision {
  using T = typename Table::scalar;
  using All = TableRules<Table, Rules...>;
  static constexpr int count = sizeof...(Rules);

  T sign[count];    // −1: the rule looks for small values
  T beyond[count];  // what sign · value exceeds; of rules that rank: see `rankings`
  std::int64_t stay[count];
  bool ranks, stores;          // whether some rule ranks; whether values are kept
  Ranking<T> const* rankings;  // (rules)
  T* values;                   // (rows, elements)
  Index elements;
  Index const* number;  // (elements)
  Tag const* tags;
  std::int64_t const* since;
  std::int64_t const* step;  // (1): of this look
  Tag* next;                 // (elements)
  std::uint32_t* refining;   // (elements): bit R: rule R refines it
  double* moves;             // (1): set to 1 where some element goes to another group

  /// Takes the values of an element; decides at once if no rule ranks.
  template <int G, class V>
  PLIANT_HOST_DEVICE void operator()(GroupNumber<G>, Index e, V const& own) const {
    if (stores)
      for (int k = 0; k < All::rows; ++k) value(e, k) = own[k];
    if constexpr ((SwitchingRule<Rules> || ...))
      if (!ranks) go<G>(e, next_group<G, 0>(e, [&](int k) { return own[k]; }));
  }
  /// Decides from the values that are kept.
  PLIANT_HOST_DEVICE void operator()(Index e) const {
    dispatch<Table::groups>(tags[e], [&]<int G>(GroupNumber<G>) {
      go<G>(e, next_group<G, 0>(e, [&](int k) { return value(e, k); }));
    });
  }
  PLIANT_HOST_DEVICE void mark_refining(Index e) const {
    std::uint32_t mask = 0;
    dispatch<Table::groups>(tags[e], [&]<int G>(GroupNumber<G>) { add_refining<G, 0>(e, mask); });
    refining[e] = mask;
  }
  PLIANT_HOST_DEVICE T& value(Index e, int row) const {
    return values[static_cast<std::ptrdiff_t>(elements) * row + e];
  }

 private:
  template <int G>
  PLIANT_HOST_DEVICE void go(Index e, Tag group) const {
    next[e] = group;
    if (group != G) *moves = 1;
  }
  template <int R>
  PLIANT_HOST_DEVICE bool holds(T value, Index e) const {
    T const signed_value = sign[R] * value;
    return ranks ? rankings[R].cut.holds(signed_value, number[e]) : signed_value > beyond[R];
  }
  template <int G, int R, class Own>
  PLIANT_HOST_DEVICE Tag next_group(Index e, Own const& own) const {
    if constexpr (R == count) {
      return static_cast<Tag>(G);
    } else {
      using TheRule = typename All::template rule<R>;
      if constexpr (All::template group<R> == G && SwitchingRule<TheRule>)
        if (holds<R>(own(All::template row<R>), e) && *step - since[e] >= stay[R])
          return static_cast<Tag>(Table::template group_of<typename TheRule::to>);
      return next_group<G, R + 1>(e, own);
    }
  }
  template <int G, int R>
  PLIANT_HOST_DEVICE void add_refining(Index e, std::uint32_t& mask) const {
    if constexpr (R < count) {
      if constexpr (All::template group<R> == G && RefiningRule<typename All::template rule<R>>)
        if (holds<R>(value(e, All::template row<R>), e)) mask |= std::uint32_t{1} << R;
      add_refining<G, R + 1>(e, mask);
    }
  }
};

template <class D>
struct MarkRefining {
  D decision;
  PLIANT_HOST_DEVICE void operator()(Index e) const { decision.mark_refining(e); }
};

}  // namespace pliant::detail
