#pragma once

#include <pliant/adaptation/choice_check.hpp>
#include <pliant/adaptation/look_time.hpp>
#include <pliant/adaptation/refinement.hpp>
#include <pliant/adaptation/rule_list.hpp>
#include <pliant/adaptation/table_check.hpp>
#include <pliant/backend/host_recording.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/leapfrog_energy.hpp>

namespace pliant::detail {

/// Begins a look: nothing moves so far, and the clock goes on to it.
struct BeginLook {
  double* moves;
  std::int64_t* clock;
  std::int64_t add;  // to what the clock says, or
  std::int64_t set;  // what it says, where `add` is 0
  PLIANT_HOST_DEVICE void operator()(Index) const {
    *moves = 0;
    *clock = add > 0 ? *clock + add : set;
  }
};

/// One look of some rules at a body: all elements are decided upon, and then act.
template <class Parts, class Rules>
class LookAt {
 public:
  /// `evaluations`: the budget of a choice now; see ChoiceCheck.
  LookAt(Parts& parts, Rules const& rules, double evaluations)
      : parts_(parts), rules_(rules), evaluations_(evaluations) {}

  /// Allocates what the rest needs.
  void prepare() const {
    if (parts_.clock.size() == 0) {
      parts_.moves = zeros<double>(parts_.backend, 1);
      parts_.clock = zeros<std::int64_t>(parts_.backend, 1);
    }
    for_each_check([](auto const& check) { check.prepare(); });
  }
  /// `later` steps after the last one; 0: now.
  void begin(int later) const {
    parts_.backend.for_each(
        1, BeginLook{parts_.moves.data(), parts_.clock.data(), later, parts_.state.steps});
  }
  void decide() const {
    auto const measured = parts_.timers.criteria.measure();
    for_each_check([](auto const& check) { check.decide(); });
  }

  /// Decides and moves elements between groups.
  void switch_groups() const {
    bool const asks = asks_whether_to_switch();
    // Those that move are compared with the step that is allowed.
    if constexpr (can_move_unasked)
      if (!asks && !step_allowance(parts_)) return decide_and_move();
    decide();
    if (asks && !something_moves()) return;
    move_elements();
    if (asks) follow_moves();
  }
  /// Refines and coarsens; returns what it has done, of which listeners are still to be told.
  auto change_mesh() const {
    int max_level = 0;
    MarkedElements marked;
    {
      auto const measured = parts_.timers.criteria.measure();
      for_each_check([&](auto const& check) { check.mark(marked, max_level); });
    }
    auto const measured = parts_.timers.migration.measure();
    auto plan = plan_change(parts_, marked, max_level);
    if (plan) commit(parts_, *plan);
    return plan;
  }
  /// Both, or nothing where the mesh cannot change.
  auto switch_and_change_mesh() const {
    bool moved = false;
    auto plan = [&] {
      try {
        if (something_moves()) {
          for_each_check([](auto const& check) { check.keep(); });
          moved = true;
          move_elements();
        }
        return change_mesh();
      } catch (...) {  // the mesh is the one of before
        if (moved) {
          for_each_check([](auto const& check) { check.put_back(); });
          regroup();
        }
        throw;
      }
    }();
    if (moved) follow_moves();
    return plan;
  }

  /// What the elements cost in their present groups: see ChoiceCheck.
  double evaluations_now() const {
    double evaluations = 0;
    for_each_check([&](auto const& check) { evaluations += check.evaluations_now(); });
    return evaluations;
  }

 private:
  template <class Visit>
  void for_each_check(Visit const& visit) const {
    parts_.for_each_type([&](auto& table, auto& elements) {
      using Table = std::remove_cvref_t<decltype(table)>;
      using Elements = std::remove_cvref_t<decltype(elements)>;
      if constexpr (Rules::chooses) {
        using R = std::remove_cvref_t<decltype(rules_.choosing())>;
        if constexpr (std::same_as<typename R::element, typename Table::element>)
          visit(ChoiceCheck<Parts, Table, Elements, R>{parts_, table, elements, rules_.choosing(),
                                                       evaluations_});
      } else {
        auto const rules = rules_on<Table>(rules_.rules);
        visit(TableCheck<Parts, Table, Elements, std::remove_cvref_t<decltype(rules)>>{
            parts_, table, elements, rules});
      }
    });
  }

  using B = typename Parts::backend_type;
  static constexpr bool can_move_unasked =
      !B::orders_by_group && !std::same_as<typename B::Recording, HostRecording>;
  /// Between the steps of leapfrog, and where no integrator has a step or accelerations, nothing follows from a
  /// switch at once but the elements' own: where the host would wait for the answer, and loops look at each
  /// tag as they go, it need not know, unless the integrator may have to follow before the next step.
  bool asks_whether_to_switch() const {
    auto const& state = parts_.state;
    return !can_move_unasked || parts_.forces_current || !state.implicit.empty() ||
           rules_.may_stiffen(parts_) || state.integrator.macro_step > 0 ||
           (state.pending_half_kick == 0 && state.integrator.step > 0);
  }
  bool something_moves() const {
    return parts_.backend.sum(1, ValueAt<double>{parts_.moves.data()}) != 0;
  }
  void decide_and_move() const {
    auto const measured = parts_.timers.criteria.measure();
    for_each_check([](auto const& check) { check.decide_and_act(); });
    forget_forces(parts_);
  }
  void move_elements() const {
    auto const allowance = step_allowance(parts_);
    book_switching(parts_, [&] {
      {
        auto const measured = parts_.timers.criteria.measure();
        if (allowance) for_each_check([](auto const& check) { check.bound_movers(); });
        for_each_check([](auto const& check) { check.act(); });
      }
      regroup();
    });
    if (allowance) for_each_check([&](auto const& check) { check.count_stiffened(*allowance); });
  }
  /// Call after tags changed.
  void regroup() const {
    if constexpr (Parts::backend_type::orders_by_group) {
      auto const measured = parts_.timers.migration.measure();
      parts_.for_each_type([&](auto& table, auto&) { table.elements.regroup(); });
    }
    forget_forces(parts_);
  }
  /// What integrators keep follows the new groups. (Where the host does not know of moves, the integrator
  /// looks for stiffer elements when it looks at the distortion.)
  void follow_moves() const {
    parts_.state.implicit.balanced = false;
    follow_switch(parts_);
  }

  Parts& parts_;
  Rules const& rules_;
  double evaluations_;
};

}  // namespace pliant::detail
