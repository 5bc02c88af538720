#pragma once

#include <pliant/adaptation/decision.hpp>
#include <pliant/adaptation/element_check.hpp>
#include <pliant/adaptation/gradient_range.hpp>
#include <pliant/adaptation/lists_on.hpp>
#include <pliant/adaptation/mesh_marks.hpp>
#include <pliant/adaptation/move_where_noted.hpp>
#include <pliant/adaptation/ranking.hpp>
#include <pliant/adaptation/refinement.hpp>
#include <pliant/adaptation/rules_on.hpp>

namespace pliant::detail {

/// One check of one element type: `decide` evaluates all criteria and changes nothing that a user
/// sees, `act` moves elements between groups, `mark` lists those to refine, to coarsen, to raise and to lower. None waits for the
/// backend, `mark` aside.
template <class Parts, class Table, class Elements, class Rules>
class TableCheck;

template <class Parts, class Table, class Elements, class... Rules>
class TableCheck<Parts, Table, Elements, std::tuple<Rules...>>
    : private ElementCheck<Parts, Table, Elements> {
  using Base = ElementCheck<Parts, Table, Elements>;
  using Base::backend, Base::workspace, Base::target, Base::looked_at;
  using Base::parts_, Base::table_, Base::elements_;
  using typename Base::B;
  using typename Base::T;
  using All = TableRules<Table, Rules...>;
  static constexpr bool switches = (SwitchingRule<Rules> || ...);
  static constexpr bool changes_mesh = (MeshRule<Rules> || ...);
  static constexpr int count = sizeof...(Rules);
  static_assert(count <= 32, "an Adaptation has at most 32 rules for one element type");
  static_assert((has_target<Table, Rules> && ...),
                "a rule names a formulation of which the body has no Group");
  static_assert(
      ((!RaisingRule<Rules> && !LoweringRule<Rules>)&&...) ||
          converted_type<typename Table::element, typename Parts::mesh_type> != no_type,
      "a rule raises or lowers, but the body's mesh has no element type of another degree "
      "on that cell");

 public:
  TableCheck(Parts& parts, Table& table, Elements& elements, std::tuple<Rules...> const& rules,
             LookedAt which = LookedAt::awake)
      : Base(parts, table, elements, which), rules_{rules} {}

  /// Allocates what `decide` and `act` need, in the first check of a mesh.
  void prepare() const {
    if constexpr (count > 0) {
      if (reserve()) ++parts_.revision;
    }
  }
  void decide() const {
    if constexpr (count > 0) {
      auto const decision = this->decision();
      evaluate_criteria(std::as_const(parts_), std::as_const(table_), elements(), rules_,
                        workspace(), decision, parts_.moves);
      if constexpr (switches)
        if (decision.ranks) {
          find_cuts(decision, []<class R>(R const&) { return SwitchingRule<R>; });
          backend().add_sum(table_.count(), decision, parts_.moves.data());
        }
    }
  }
  void act() const {
    if constexpr (switches) this->move_by(rules_);
  }
  /// Both, in one loop where each element's own values say where it goes. Of linear simplices alone: what moves other
  /// elements takes so many registers that it slows their criteria down.
  void decide_and_act() const {
    if constexpr (LinearSimplex<typename Table::element> && switches && !changes_mesh)
      if (!ranks())
        return evaluate_criteria(
            std::as_const(parts_), std::as_const(table_), elements(), rules_, workspace(),
            MoveAtOnce<Table, Parts::dim, Rules...>{decision(), this->mover_by(rules_)},
            elements_.statistics.counters, std::as_const(parts_).v());
    decide();
    act();
  }

  /// Whether a screen may tell which patches to look at: see Screen.
  static constexpr bool can_screen =
      count == 0 || (LinearSimplex<typename Table::element> && !changes_mesh &&
                     (BoundedCriterion<decltype(Rules::criterion)> && ...));
  bool screens() const { return !ranks(); }
  Screen<T, Table::groups> screen() const {
    Screen<T, Table::groups> made{{}, {}, workspace().noted.data(), parts_.clock.data()};
    [&]<int... G>(std::integer_sequence<int, G...>) {
      ((made.above[G] = range<G>()[0], made.below[G] = range<G>()[1]), ...);
    }(std::make_integer_sequence<int, Table::groups>());
    return made;
  }
  /// Lists the patches that the screen has noted for the look that has begun; on the host. Whether there are some.
  bool list_noted() const {
    if constexpr (count == 0) {
      return false;
    } else {
      auto const screen = this->screen();
      auto const bounds = table_.elements.patch_bounds();
      auto const awake = parts_.awake_in(table_);
      std::vector<Index> list{0};
      for (Index k = 0; k < awake.patch_count(); ++k)
        if (auto const p = static_cast<std::size_t>(awake.patch(k));
            screen.selects_some(bounds[p], bounds[p + 1]))
          list.push_back(awake.patch(k));
      list[0] = static_cast<Index>(list.size()) - 1;
      std::ranges::copy(list, workspace().flagged.data());
      return list[0] > 0;
    }
  }
  /// Decides and moves in one loop over the patches that are noted, whose forces follow.
  void act_where_noted(std::optional<StepAllowance> const& allowance) const {
    if constexpr (count > 0) {
      auto mover = this->mover_by(rules_);
      mover.target.forces = parts_.layout.f.data();
      auto const limit = allowance.value_or(StepAllowance{});
      evaluate_criteria(
          std::as_const(parts_), std::as_const(table_), parts_.awake_in(table_), rules_,
          workspace(),
          MoveWhereNoted<Table, Parts::dim, Rules...>{
              {decision(), mover},
              screen(),
              spectra_of(parts_, table_),
              allowance ? parts_.state.work.data() + static_cast<int>(Work::stiffened) : nullptr,
              static_cast<T>(limit.growth * limit.squared_frequency),
              static_cast<T>(limit.growth)},
          elements_.statistics.counters, std::as_const(parts_).v());
    }
  }

  void bound_movers() const {
    if constexpr (switches) this->bound_those_that_move();
  }
  void count_stiffened(StepAllowance const& allowance) const {
    if constexpr (switches) this->count_those_stiffened(allowance);
  }

  /// Marks the elements that rules want changed, and adds what the marks mean.
  void mark(MeshMarks& marks) const {
    marks.add(rules_.rules);
    if constexpr (changes_mesh) {
      auto const decision = this->decision();
      if (decision.ranks) find_cuts(decision, []<class R>(R const&) { return MeshRule<R>; });
      backend().for_each(table_.count(), MarkForMesh<Decision<Table, Rules...>>{decision});
    }
  }
  void keep() const {
    if constexpr (switches) this->keep_what_moves_change();
  }
  void put_back() const {
    if constexpr (switches) this->put_back_what_moves_change();
  }

 private:
  // What of the body is read and changed.
  /// Those that are looked at: of rules that compare elements with each other, and of those that refine, all.
  auto elements() const { return changes_mesh || ranks() ? active(table_.elements) : looked_at(); }
  /// Whether something was allocated.
  bool reserve() const {
    typename Base::Room room(*this);
    if constexpr (switches) room.hold_switching();
    if constexpr (can_screen && count > 0) {
      auto const patches = static_cast<std::size_t>(table_.elements.patch_count());
      room.hold(workspace().noted, static_cast<std::size_t>(PatchRanges::runs(table_.count())));
      room.hold(workspace().flagged, patches + 1);
    }
    if constexpr (changes_mesh) {
      auto& w = workspace();
      room.hold(w.mesh_marks, room.count());
      if (w.levels.size() < room.count()) {
        w.levels = levels_on_backend(parts_, table_);
        room.made = true;
      }
    }
    if (changes_mesh || ranks()) room.hold_values(All::rows);
    if (ranks()) {
      room.hold_ranking(std::size_t{count});
      room.hold(workspace().candidates, room.count());
    }
    return room.made;
  }

  bool ranks() const {
    return std::apply([](auto const&... rule) { return (rule.marking.ranks() || ...); },
                      rules_.rules);
  }
  Decision<Table, Rules...> decision() const {
    auto& w = workspace();
    auto const own = target();
    Decision<Table, Rules...> d{{},
                                {},
                                {},
                                {},
                                ranks(),
                                changes_mesh || ranks(),
                                w.rankings.data(),
                                w.values.data(),
                                table_.count(),
                                w.number.data(),
                                own.tags,
                                own.since,
                                own.step,
                                w.levels.data(),
                                w.next.data(),
                                w.mesh_marks.data(),
                                {}};
    int r = 0;
    auto const add = [&]<class R>(R const& rule) {
      d.sign[r] = rule.marking.below() ? T(-1) : T(1);
      d.beyond[r] = rule.marking.template beyond<T>();
      if constexpr (SwitchingRule<R>) d.stay[r] = rule.stay;
      if constexpr (RefiningRule<R>) d.level[r] = rule.options.max_level;
      if constexpr (CoarseningRule<R>) d.level[r] = rule.options.min_level;
      ++r;
    };
    std::apply([&](auto const&... rule) { (add(rule), ...); }, rules_.rules);
    [&]<int... G>(std::integer_sequence<int, G...>) {
      ((d.quiet[G] = quiet<G>()), ...);
    }(std::make_integer_sequence<int, Table::groups>());
    return d;
  }
  /// H:H between which elements of group G may act: see Screen.
  template <int G>
  std::array<T, 2> range() const {
    return gradient_range<Table, G, T, Parts::dim>(rules_.rules);
  }
  /// See Decision::quiet.
  template <int G>
  T quiet() const {
    if constexpr (!Decision<Table, Rules...>::template bounded<G>)
      return T(-1);
    else if (changes_mesh || ranks())
      return T(-1);  // values are kept, and compared
    else
      return range<G>()[0];
  }
  template <class TheDecision, class Chosen>
  void find_cuts(TheDecision const& decision, Chosen const& chosen) const {
    [&]<int... R>(std::integer_sequence<int, R...>) {
      (find_cut_of<R>(decision, chosen(std::get<R>(rules_.rules))), ...);
    }(std::make_integer_sequence<int, count>());
  }
  template <int R, class TheDecision>
  void find_cut_of(TheDecision const& decision, bool chosen) const {
    if (!chosen) return;
    auto& w = workspace();
    auto const& marking = std::get<R>(rules_.rules).marking;
    if (marking.ranks())
      backend().for_each(table_.count(),
                         FindCandidates<R, TheDecision>{decision, w.candidates.data()});
    auto const offset = static_cast<std::ptrdiff_t>(table_.count()) * All::template row<R>;
    find_cut(backend(), marking,
             RankedValues<T>{w.values.data() + offset, w.candidates.data(), w.number.data(),
                             table_.count(), marking.below() ? T(-1) : T(1)},
             w.histogram.data(), w.rankings.data() + R);
  }

  All rules_;
};

}  // namespace pliant::detail
