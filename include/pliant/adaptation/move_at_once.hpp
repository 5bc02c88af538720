#pragma once

#include <pliant/adaptation/decision.hpp>
#include <pliant/adaptation/switching.hpp>

namespace pliant::detail {

/// Moves each element in the loop that evaluates its criteria: where no rule ranks, and neither the host nor a rule that
/// changes the mesh needs to know in between.
template <class Table, int Dim, class... Rules>
struct MoveAtOnce {
  using Decides = Decision<Table, Rules...>;
  using Moves = ActVisitor<Table, Dim, Rules...>;
  static constexpr int counters = Moves::counters;
  static constexpr bool finishes_few = true;
  template <int G>
  static constexpr bool bounded = Decides::template bounded<G>;

  Decides decision;
  Moves moves;

  PLIANT_HOST_DEVICE typename Table::scalar quiet_below(int group) const {
    return decision.quiet_below(group);
  }
  template <int G, class V, class Again, class Tally>
  PLIANT_HOST_DEVICE void operator()(GroupNumber<G>, Index e, V const& own, Again const& again,
                                     Tally const& tally) const {
    Tag const to = decision.template next_group_by<G>(e, own);
    if (to != G) moves.template move_to<G>(to, e, again, tally);
  }
};

}  // namespace pliant::detail
