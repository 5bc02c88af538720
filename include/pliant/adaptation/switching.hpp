#pragma once

#include <pliant/adaptation/criteria_visitor.hpp>
#include <pliant/adaptation/rule.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/group_statistics.hpp>
#include <pliant/body/point_visitors.hpp>
#include <pliant/formulation/strong_ellipticity.hpp>

namespace pliant::detail {

/// A rule whose moves are made only where the new law is strongly elliptic.
template <class R>
concept GuardsEllipticity = SwitchingRule<R> && requires { requires R::guards_ellipticity; };

/// What of a body changes where elements change groups, and what must be known of its motion.
template <class T>
struct SwitchTarget {
  Tag* tags;
  std::int64_t* since;       // step of the last change of group
  std::int32_t* switches;    // changes of group so far
  std::int64_t const* step;  // (1): of this look
  T pending_half_kick;       // s; 0: velocities are those of the present time
  T* forces;  // (nodes, 4), N: which follow moves while a half-kick is pending; may be null
};

/// Moves the elements whose next group is another: tags change, and statistics are updated.
template <class Table, int Dim, class... Rules>
struct ActVisitor {
  using T = typename Table::scalar;
  using Laws = typename Table::Laws;
  using All = TableRules<Table, Rules...>;
  using Counters = CounterLayout<Table::groups>;
  static constexpr int counters = Counters::count;
  static constexpr bool changes_mesh = (MeshRule<Rules> || ...);

  Laws groups;
  All rules;
  Surroundings<T, Dim, Table::groups> around;
  Tag const* next;  // (elements)
  T* values;        // (rows, elements)
  Index elements;
  SwitchTarget<T> target;

  PLIANT_HOST_DEVICE bool selects(Index e, Tag group) const { return next[e] != group; }
  template <int G, class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const& rest, V const&, V const&) const {
    return Vector<std::remove_cvref_t<decltype(rest(0, 0))>, 1>{};
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const&, Again const& again,
                                 Tally const& tally) const {
    if (Tag const to = next[e]; to != G) move_to<G>(to, e, again, tally);
  }
  /// Moves an element of group From to another one to which some rule moves those. again() gives coordinates, displacements
  /// and velocities at its nodes.
  template <int From, int To = 0, class Again, class Tally>
  PLIANT_HOST_DEVICE void move_to(Tag to, Index e, Again const& again, Tally const& tally) const {
    if constexpr (To < Table::groups) {
      if constexpr (goes<From, To>)
        if (to == To) return move<From, To>(e, again, tally);
      move_to<From, To + 1>(to, e, again, tally);
    }
  }

 private:
  template <int From, int To, class TheRule>
  static constexpr bool goes_by() {
    if constexpr (SwitchingRule<TheRule>)
      return Table::template group_of<typename TheRule::from> == From &&
             Table::template group_of<typename TheRule::to> == To;
    else
      return false;
  }
  template <int From, int To>
  static constexpr bool goes = From != To && (goes_by<From, To, Rules>() || ...);

  template <int From, int To, class TheRule>
  static constexpr bool guards_by() {
    if constexpr (GuardsEllipticity<TheRule>)
      return goes_by<From, To, TheRule>();
    else
      return false;
  }

  /// What leapfrog keeps is W + v₋·M·v₊/2 with the velocities v∓ of the half steps around the present time.
  /// While a half-kick is pending, the next step finds v₊ = v₋ + Δt M⁻¹ F, so that a change ΔF of an element's forces adds
  /// Δt/2 v₋·ΔF to the change of W. (Of velocities of the present time: see book_switching.)
  template <int From, int To, class Again, class Tally>
  PLIANT_SELDOM void move(Index e, Again const& again, Tally const& tally) const {
    using Old = typename Table::template formulation<From>;
    using New = typename Table::template formulation<To>;
    OneElement const own{e};
    auto const old_law = groups.template law<From>(own);
    auto const new_law = groups.template law<To>(own);
    auto const [rest, u, v] = again();
    if constexpr ((guards_by<From, To, Rules>() || ...))
      if (!is_strongly_elliptic<New>(new_law, rest, u)) return;
    T const before = energy<Old>(old_law, rest, u);
    bool const pending = target.pending_half_kick != T(0);
    auto change = decltype(force<Old>(old_law, rest, u))::zero();  // of the element's forces
    if (pending) change = force<Old>(old_law, rest, u);
    carry_internal_variables<From, To>(groups, e, rest, u);
    T const after = energy<New>(new_law, rest, u);
    if (pending) change = force<New>(new_law, rest, u) - change;
    if constexpr (requires { again.add(NodeField<T, Dim>{}, change); })
      if (pending && target.forces != nullptr) again.add(NodeField<T, Dim>{target.forces}, change);
    if constexpr (changes_mesh) {
      // What rules that change the mesh look at next.
      auto const now = rules.template evaluate<To>(new_law, rest, u, groups, around, own);
      for (int k = 0; k < All::rows; ++k)
        values[static_cast<std::ptrdiff_t>(elements) * k + e] = now[k];
    }
    double const strain = static_cast<double>(after - before);
    double const kinetic = static_cast<double>(target.pending_half_kick * dot(change, v));
    bool const booked = is_finite(strain) && is_finite(kinetic);
    tally(Counters::steps_of(From), static_cast<double>(*target.step - target.since[e]));
    tally(Counters::moves(From, To), 1.0);
    tally(booked ? Counters::energy(From, To) : Counters::unbooked, booked ? strain : 1.0);
    if (booked) tally(Counters::kinetic(From, To), kinetic);
    target.tags[e] = static_cast<Tag>(To);
    target.since[e] = *target.step;
    target.switches[e] = one_more(target.switches[e]);
  }
};

}  // namespace pliant::detail
