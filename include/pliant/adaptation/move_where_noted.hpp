#pragma once

#include <optional>

#include <pliant/adaptation/move_at_once.hpp>
#include <pliant/adaptation/screen.hpp>
#include <pliant/solver/stiffening.hpp>

namespace pliant::detail {

/// Moves each element of the patches that a screen has noted in the loop that evaluates its criteria, and says whether
/// one is stiffer then than before and than the step allows.
template <class Table, int Dim, class... Rules>
struct MoveWhereNoted : MoveAtOnce<Table, Dim, Rules...> {
  using Base = MoveAtOnce<Table, Dim, Rules...>;
  using T = typename Table::scalar;
  static constexpr int groups = Table::groups;

  Screen<T, groups> screen;
  ElementSpectra<T, typename Table::Laws> spectra;
  double* stiffened;  // (1); null: not asked
  T most, growth;     // see CountStiffened

  PLIANT_HOST_DEVICE bool selects(Index e, Tag) const { return screen.selects(e); }
  template <int G, class V, class Again, class Tally>
  PLIANT_HOST_DEVICE void operator()(GroupNumber<G> group, Index e, V const& own,
                                     Again const& again, Tally const& tally) const {
    Tag const to = this->decision.template next_group_by<G>(e, own);
    if (to != G) move(group, to, e, again, tally);
  }

 private:
  template <int G, class Again, class Tally>
  PLIANT_SELDOM void move(GroupNumber<G> group, Tag to, Index e, Again const& again,
                          Tally const& tally) const {
    T const before = stiffened ? bound_of(group, e, again) : T(0);
    this->moves.template move_to<G>(to, e, again, tally);
    if (!stiffened || this->moves.target.tags[e] != to) return;
    dispatch<groups>(to, [&](auto now) {
      T const after = bound_of(now, e, again);
      if (!(after <= most) && !(after <= growth * before)) *stiffened = 1;  // as any other thread
    });
  }
  template <class Group, class Again>
  PLIANT_HOST_DEVICE T bound_of(Group group, Index e, Again const& again) const {
    auto const [rest, u, v] = again();
    return evaluate_at(spectra, group, OneElement{e}, rest, u)[0];
  }
};

}  // namespace pliant::detail
