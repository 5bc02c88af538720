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
  int level[count];            // the largest of rules that refine; the least of those that coarsen
  bool ranks, stores;          // whether some rule ranks; whether values are kept
  Ranking<T> const* rankings;  // (rules)
  T* values;                   // (rows, elements)
  Index elements;
  Index const* number;  // (elements)
  Tag const* tags;
  std::int64_t const* since;
  std::int64_t const* step;   // (1): of this look
  int const* levels;          // (elements): how often each was refined
  Tag* next;                  // (elements)
  std::uint32_t* mesh_marks;  // (elements): bit R: rule R refines it, or would merge it

  T quiet[Table::groups];  // H:H up to which no element of a group acts; negative: not known

  /// Of the elements that go to another group.
  static constexpr int counters = 1;
  /// Whether every criterion that looks at group G, and some does, bounds the gradients of those that act.
  template <int G>
  static constexpr bool bounded = LinearSimplex<typename Table::element> &&
                                  ((Table::template group_of<typename Rules::from> == G) || ...) &&
                                  ((Table::template group_of<typename Rules::from> != G ||
                                    BoundedCriterion<decltype(Rules::criterion)>)&&...);

  /// Takes the values of an element; decides at once if no rule ranks.
  template <int G, class V, class Again, class Tally>
  PLIANT_HOST_DEVICE void operator()(GroupNumber<G>, Index e, V const& own, Again const&,
                                     Tally const& tally) const {
    if (stores)
      for (int k = 0; k < All::rows; ++k) value(e, k) = own[k];
    if constexpr ((SwitchingRule<Rules> || ...))
      if (!ranks && goes<G>(e, [&](int k) { return own[k]; })) tally(0, 1.0);
  }
  /// Decides from the values that are kept; 1 where the element goes to another group.
  PLIANT_HOST_DEVICE double operator()(Index e) const {
    bool moves = false;
    dispatch<Table::groups>(tags[e], [&]<int G>(GroupNumber<G>) {
      moves = goes<G>(e, [&](int k) { return value(e, k); });
    });
    return moves ? 1 : 0;
  }
  /// What an element is to rule R, when the cuts of the rules before it are known.
  template <int R>
  PLIANT_HOST_DEVICE Candidate candidate(Index e) const {
    if (tags[e] != static_cast<Tag>(All::template group<R>)) return Candidate::none;
    return may_act<R>(e) && !is_taken<R, 0>(e) ? Candidate::may_act : Candidate::looked_at;
  }
  PLIANT_HOST_DEVICE void mark_for_mesh(Index e) const {
    std::uint32_t mask = 0;
    dispatch<Table::groups>(tags[e], [&]<int G>(GroupNumber<G>) { add_marks<G, 0>(e, mask); });
    mesh_marks[e] = mask;
  }
  PLIANT_HOST_DEVICE T quiet_below(int group) const { return quiet[group]; }
  /// The group that an element goes to, or stays in, by its own values, where no rule ranks.
  template <int G, class V>
  PLIANT_HOST_DEVICE Tag next_group_by(Index e, V const& own) const {
    return next_group<G, 0>(e, [&](int k) { return own[k]; });
  }
  PLIANT_HOST_DEVICE T& value(Index e, int row) const {
    return values[static_cast<std::ptrdiff_t>(elements) * row + e];
  }

 private:
  template <int R>
  static constexpr bool switches = SwitchingRule<typename All::template rule<R>>;

  /// Notes the group that an element is in next; whether that is another.
  template <int G, class Own>
  PLIANT_HOST_DEVICE bool goes(Index e, Own const& own) const {
    Tag const group = next_group<G, 0>(e, own);
    next[e] = group;
    return group != G;
  }
  /// Whether an element's stay or level lets it act by a rule.
  template <int R>
  PLIANT_HOST_DEVICE bool may_act(Index e) const {
    if constexpr (switches<R>)
      return *step - since[e] >= stay[R];
    else if constexpr (RefiningRule<typename All::template rule<R>>)
      return levels[e] < level[R];
    else if constexpr (CoarseningRule<typename All::template rule<R>>)
      return levels[e] > level[R];
    else
      return true;
  }
  /// Whether a rule before R that does the like acts on an element of its group.
  template <int R, int K>
  PLIANT_HOST_DEVICE bool is_taken(Index e) const {
    if constexpr (K == R) {
      return false;
    } else {
      if constexpr (All::template group<K> == All::template group<R> && switches<K> == switches<R>)
        if (acts<K>(value(e, All::template row<K>), e)) return true;
      return is_taken<R, K + 1>(e);
    }
  }
  template <int R>
  PLIANT_HOST_DEVICE bool acts(T value, Index e) const {
    return holds<R>(value, e) && may_act<R>(e);
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
      if constexpr (All::template group<R> == G && switches<R>)
        if (acts<R>(own(All::template row<R>), e))
          return static_cast<Tag>(Table::template group_of<typename TheRule::to>);
      return next_group<G, R + 1>(e, own);
    }
  }
  template <int G, int R>
  PLIANT_HOST_DEVICE void add_marks(Index e, std::uint32_t& mask) const {
    if constexpr (R < count) {
      if constexpr (All::template group<R> == G && MeshRule<typename All::template rule<R>>)
        if (acts<R>(value(e, All::template row<R>), e)) mask |= std::uint32_t{1} << R;
      add_marks<G, R + 1>(e, mask);
    }
  }
};

/// Finds what elements are to rule R.
template <int R, class D>
struct FindCandidates {
  D decision;
  Candidate* candidates;  // (elements)
  PLIANT_HOST_DEVICE void operator()(Index e) const {
    candidates[e] = decision.template candidate<R>(e);
  }
};

template <class D>
struct MarkForMesh {
  D decision;
  PLIANT_HOST_DEVICE void operator()(Index e) const { decision.mark_for_mesh(e); }
};

}  // namespace pliant::detail
