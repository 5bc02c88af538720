#pragma once

#include <pliant/adaptation/choice_check.hpp>
#include <pliant/adaptation/look_time.hpp>
#include <pliant/adaptation/mesh_spending.hpp>
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
  LookAt(Parts& parts, Rules const& rules, double evaluations, LookedAt looked_at = LookedAt::awake)
      : parts_(parts), rules_(rules), evaluations_(evaluations), looked_at_(looked_at) {}

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
  /// Whether the forces of the next step may tell which patches to look at: where that is told of all elements that rules
  /// look at, and, in a recording, moves can put their forces right.
  bool screens() const {
    if constexpr (!can_screen) {
      return false;
    } else {
      bool can = on_host || parts_.layout.interpolation.empty();
      for_each_check([&](auto const& check) { can = can && check.screens(); });
      return can;
    }
  }
  /// Decides where the forces of the next step, which it evaluates, tell that elements may act, and moves these; forces
  /// are forgotten then. On the host, where they are not known yet; elsewhere as switch_groups.
  void switch_by_forces() const {
    if constexpr (!can_screen || !on_host) {
      switch_groups();
    } else {
      if (parts_.forces_current || !screens()) return switch_groups();
      evaluate_forces(parts_, ScreenedKernels{*this});
      bool some = false;
      for_each_check([&](auto const& check) { some = check.list_noted() || some; });
      if (some) LookAt(parts_, rules_, evaluations_, LookedAt::flagged).switch_groups();
    }
  }
  /// The same in a recording, once forces are cleared and while a half-kick is pending: what moves puts them right.
  void loop_by_forces() const {
    if constexpr (can_screen && !on_host) {
      accumulate_awake_forces(std::as_const(parts_), parts_.f(), ScreenedKernels{*this});
      auto const allowance = step_allowance(parts_);
      for_each_check([&](auto const& check) { check.act_where_noted(allowance); });
    }
  }

  /// Decides, switches groups and changes the mesh, or does nothing where the mesh cannot change. Returns what it has done
  /// to the mesh, of which listeners are still to be told.
  auto change() const {
    if constexpr (Rules::holds_mesh) {
      auto const marks = [&] {
        auto const measured = parts_.timers.criteria.measure();
        return decide_on_mesh(parts_, rules_.holding(), evaluations_);
      }();
      return switch_and_change_mesh([&] { return marks; });
    } else {
      decide();
      return switch_and_change_mesh([&] {
        auto const measured = parts_.timers.criteria.measure();
        MeshMarks marks;
        for_each_check([&](auto const& check) { check.mark(marks); });
        return marks;
      });
    }
  }

  /// What the elements cost in their present groups: see ChoiceCheck.
  double evaluations_now() const {
    if constexpr (Rules::holds_mesh) {
      return evaluations_of_mesh(std::as_const(parts_), rules_.holding());
    } else {
      double evaluations = 0;
      for_each_check([&](auto const& check) { evaluations += check.evaluations_now(); });
      return evaluations;
    }
  }

 private:
  /// `find_marks` looks at the groups after the switch.
  template <class FindMarks>
  auto switch_and_change_mesh(FindMarks const& find_marks) const {
    bool moved = false;
    auto to_tell = [&] {
      try {
        if constexpr (Rules::switches) {
          if (something_moves()) {
            for_each_check([](auto const& check) { check.keep(); });
            moved = true;
            move_elements();
          }
        }
        MeshMarks const marks = find_marks();
        auto const measured = parts_.timers.migration.measure();
        if (auto done = change_on_backend(parts_, marks)) return std::move(done->to_tell);
        ToTell<typename Parts::mesh_type, typename Parts::backend_type> found;
        found.plan =
            plan_change(parts_, marked_elements(std::as_const(parts_), marks), marks.max_level);
        if (found.plan) commit(parts_, *found.plan);
        return found;
      } catch (...) {  // where some of the mesh has changed, what was kept is gone, and moves stay
        if (moved) {
          for_each_check([](auto const& check) { check.put_back(); });
          regroup();
        }
        throw;
      }
    }();
    if (moved) follow_moves();
    return to_tell;
  }

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
      } else if constexpr (Rules::holds_mesh) {
        visit(HeldCheck<Parts, Table, Elements, std::remove_cvref_t<decltype(rules_.holding())>>{
            parts_, table, elements});
      } else {
        auto const rules = rules_on<Table>(rules_.rules);
        visit(TableCheck<Parts, Table, Elements, std::remove_cvref_t<decltype(rules)>>{
            parts_, table, elements, rules, looked_at_});
      }
    });
  }

  using B = typename Parts::backend_type;
  static constexpr bool on_host = std::same_as<typename B::Recording, HostRecording>;
  static constexpr bool can_move_unasked = !B::orders_by_group && !on_host;

  template <class Table>
  static constexpr bool can_screen_table = [] {
    using Checked = decltype(rules_on<Table>(std::declval<Rules const&>().rules));
    return TableCheck<Parts, Table, char, Checked>::can_screen;
  }();
  static constexpr bool can_screen = [] {
    if constexpr (!Rules::switches || Rules::chooses || Rules::changes_mesh || Rules::takes_means ||
                  Parts::has_internal_variables)
      return false;
    else
      return []<class... Tables>(std::type_identity<std::tuple<Tables...>>) {
        return (can_screen_table<Tables> && ...);
      }(std::type_identity<decltype(Parts::layout_type::tables)>{});
  }();

  /// The kernels of forces that screens see, of tables that rules look at.
  struct ScreenedKernels {
    LookAt const& look;
    template <class Table, class Laws, Geometry How>
    auto operator()(Table const&, ForceKernel<Laws, How> const& kernel) const {
      using Checked = decltype(rules_on<Table>(look.rules_.rules));
      if constexpr (std::tuple_size_v<Checked> == 0) {
        return kernel;
      } else {
        using TheScreen = Screen<typename Parts::T, Table::groups>;
        return ScreenedForceKernel<Laws, How, TheScreen>{kernel, look.template screen_of<Table>()};
      }
    }
  };
  template <class Table>
  auto screen_of() const {
    constexpr std::size_t type = Parts::layout_type::template type_of<typename Table::element>;
    auto& elements = std::get<type>(parts_.state.elements);
    auto const rules = rules_on<Table>(rules_.rules);
    return TableCheck<Parts, Table, std::remove_reference_t<decltype(elements)>,
                      std::remove_cvref_t<decltype(rules)>>{
        parts_, std::get<type>(parts_.layout.tables), elements, rules}
        .screen();
  }
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
  LookedAt looked_at_;
};

}  // namespace pliant::detail
