#pragma once

#include <pliant/adaptation/lists_on.hpp>
#include <pliant/adaptation/switching.hpp>
#include <pliant/body/criteria_workspace.hpp>
#include <pliant/solver/stiffening.hpp>

namespace pliant::detail {

/// Which patches are looked at: those awake, or those of them that a screen has noted and a list names.
enum class LookedAt { awake, flagged };

/// What checks of the elements of one type have in common, whatever decides: what they read, change and allocate.
/// None waits for the backend.
template <class Parts, class Table, class Elements>
class ElementCheck {
 protected:
  using B = typename Parts::backend_type;
  using T = typename Parts::T;

  ElementCheck(Parts& parts, Table& table, Elements& elements, LookedAt looked_at = LookedAt::awake)
      : parts_(parts), table_(table), elements_(elements), looked_at_(looked_at) {}

  B const& backend() const { return parts_.backend; }
  CriteriaWorkspace<B>& workspace() const { return table_.criteria; }
  SwitchTarget<T> target() const {
    auto& statistics = elements_.statistics;
    return {elements_.tags.data(),
            statistics.since.data(),
            statistics.switches.data(),
            parts_.clock.data(),
            static_cast<T>(parts_.state.pending_half_kick),
            nullptr};
  }
  /// The elements that may move.
  auto looked_at() const {
    return looked_at_ == LookedAt::flagged ? over(table_.elements, workspace().flagged)
                                           : parts_.awake_in(table_);
  }
  /// What moves elements by some rules.
  template <class... Rules>
  ActVisitor<Table, Parts::dim, Rules...> mover_by(TableRules<Table, Rules...> const& rules) const {
    return {table_.laws,
            rules,
            surroundings<T, TableRules<Table, Rules...>>(std::as_const(parts_),
                                                         std::as_const(table_), workspace()),
            workspace().next.data(),
            workspace().values.data(),
            table_.count(),
            target()};
  }
  /// Moves elements to their next groups, by the moves of some rules.
  template <class... Rules>
  void move_by(TableRules<Table, Rules...> const& rules) const {
    backend().template visit<Table::groups>(looked_at(), mover_by(rules),
                                            elements_.statistics.counters, parts_.rest(),
                                            std::as_const(parts_).u(), std::as_const(parts_).v());
  }

  /// Before and after moves: how stiff the elements are that they concern.
  void bound_those_that_move() const {
    bound_movers(parts_, table_, looked_at(), workspace().next.data());
  }
  void count_those_stiffened(StepAllowance const& allowance) const {
    count_stiffened(parts_, table_, looked_at(), allowance, elements_.statistics.since.data(),
                    parts_.clock.data());
  }

  /// Keeps what moves change, and puts it back.
  void keep_what_moves_change() const {
    each_kept([this](auto& own, auto& kept) { copy(own, kept); });
  }
  void put_back_what_moves_change() const {
    each_kept([this](auto& own, auto& kept) { copy(kept, own); });
  }

  /// Allocates what is not there yet, and knows whether something was: recorded loops read it where it lies.
  class Room {
   public:
    explicit Room(ElementCheck const& check) : check_(check) {}

    bool made = false;
    template <class U>
    void hold(typename B::template Array<U>& array, std::size_t size) {
      made = CriteriaWorkspace<B>::reserve(check_.backend(), array, size) || made;
    }
    /// For elements that change groups.
    void hold_switching() {
      hold(check_.workspace().next, count());
      hold(check_.table_.scratch, count());
      auto& statistics = check_.elements_.statistics;
      if (statistics.open) return;
      statistics.start(check_.backend(), check_.table_.count(), check_.parts_.state.record.born);
      made = true;
    }
    /// For elements that are compared with each other.
    void hold_ranking(std::size_t rankings) {
      auto& w = check_.workspace();
      if (w.number.size() < count()) {
        w.number = numbers_on_backend(check_.parts_, check_.table_);
        made = true;
      }
      hold(w.rankings, rankings);
      hold(w.histogram, std::size_t{histogram_bins});
    }
    /// Rows of a value for each element.
    void hold_values(int rows) {
      hold(check_.workspace().values, static_cast<std::size_t>(rows) * count());
    }
    std::size_t count() const { return static_cast<std::size_t>(check_.table_.count()); }

   private:
    ElementCheck const& check_;
  };

  Parts& parts_;
  Table& table_;
  Elements& elements_;
  LookedAt looked_at_;

 private:
  template <class Visit>
  void each_kept(Visit const& visit) const {
    auto& statistics = elements_.statistics;
    auto& kept = workspace().kept;
    visit(elements_.tags, kept.tags);
    visit(statistics.since, kept.since);
    visit(statistics.switches, kept.switches);
    visit(statistics.counters, kept.counters);
    visit(parts_.state.work, kept.work);  // of all tables, in each the same
    visit(elements_.internal_variables, kept.internal_variables);
  }
  template <class U>
  using Array = typename B::template Array<U>;
  template <class U>
  void copy(Array<U>& from, Array<U>& to) const {
    CriteriaWorkspace<B>::reserve(backend(), to, from.size());
    copy_values<B, U>(backend(), from.data(), to.data(), from.size());
  }
};

}  // namespace pliant::detail
