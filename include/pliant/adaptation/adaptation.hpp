#pragma once

#include <algorithm>
#include <memory>

#include <pliant/adaptation/choice_check.hpp>
#include <pliant/adaptation/look_key.hpp>
#include <pliant/adaptation/look_time.hpp>
#include <pliant/adaptation/refinement.hpp>
#include <pliant/adaptation/sleep_look.hpp>
#include <pliant/adaptation/strategy.hpp>
#include <pliant/adaptation/table_check.hpp>
#include <pliant/backend/host_recording.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/leapfrog_energy.hpp>

namespace pliant {

namespace detail {

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

}  // namespace detail

/// Algorithm 1 of Caillaud et al. 2013, in parallel: at intervals, every rule's criterion is evaluated
/// for the elements of its formulation, and the elements that it marks act. Where several rules that
/// switch look at one formulation, the first that holds acts. Rules that switch go before rules that
/// refine or coarsen, which look at the groups after it, and these before one that puts patches to sleep. In sleeping patches
/// nothing switches. An element where a criterion is NaN does not act by that rule.
template <Rule... Rules>
class Adaptation {
 public:
  explicit Adaptation(Rules... rules)
      : rules_key_(detail::rules_key(rules...)), rules_(std::move(rules)...) {}

  /// Looks every n steps only; 8 when not said.
  Adaptation&& every(int calls) && {
    set_interval(calls);
    return std::move(*this);
  }
  Adaptation& every(int calls) & {
    set_interval(calls);
    return *this;
  }
  /// Call after each step. The body's state remembers the step of the last look, so that a run that is
  /// rolled back or loaded looks when the one before would have: of Adaptations with equal rules, those that
  /// are first called in the same order. Copies count as one.
  template <DeformableBody TheBody>
  void operator()(TheBody& body) {
    if (steps_to_look(body, body.steps() - 1) > 1) return;
    now(body);
    // Another mesh puts another state in place of the one that was looked at.
    last_look(body.parts(), body.steps()).step = body.steps();
  }

  /// Looks and acts at once, whatever the interval. When it throws (the mesh would exceed the mesh's
  /// limits, a force term cannot be made anew, or a criterion throws on a backend that lets it), the body is
  /// as it was; but for what listeners throw, who are told when all is done.
  template <DeformableBody TheBody>
  void now(TheBody& body) {
    static_assert((acts_on<TheBody, Rules>() && ...),
                  "a rule is for an element type that the body's mesh does not have");
    auto& parts = body.parts();
    prepare(parts);
    if constexpr (chooses) take_time(parts);
    begin_look(parts, 0);
    decide(parts);
    if constexpr (switches && changes_mesh) {
      bool moved = false;
      auto const plan = [&] {
        try {
          if (something_moves(parts)) {
            for_each_check(parts, [](auto const& check) { check.keep(); });
            moved = true;
            move_elements(parts);
          }
          return change_mesh(parts);
        } catch (...) {  // the mesh is the one of before
          if (moved) {
            for_each_check(parts, [](auto const& check) { check.put_back(); });
            regroup(parts);
          }
          throw;
        }
      }();
      if (moved) follow_moves(parts);
      if (plan) tell_listeners(parts, *plan);
    } else if constexpr (switches) {
      switch_groups(parts);
    } else if constexpr (changes_mesh) {
      if (auto const plan = change_mesh(parts)) tell_listeners(parts, *plan);
    }
    if constexpr (sleeps) {
      static_assert(!TheBody::has_internal_variables,
                    "sleep takes no laws with internal variables, which go on relaxing at rest");
      look_for_rest(parts, sleep_rule());
    }
    if constexpr (chooses) start_time(parts);
  }

  int interval() const { return interval_; }
  /// How many calls it takes until one looks, 1 or more, when the last call was at the present step.
  template <DeformableBody TheBody>
  int steps_to_look(TheBody& body) {
    return steps_to_look(body, body.steps());
  }
  /// For integrators: take(look) takes n steps in which each look is recorded together with the steps before
  /// it (see take_stretches) and returns n; 0 where it took none.
  template <DeformableBody TheBody, class Take>
  int take_stretches(TheBody& body, Take const& take) {
    auto& parts = body.parts();
    int const taken = take(RecordedLook{*this});
    if (taken > 0) last_look(parts, parts.state.steps).step = parts.state.steps;
    return taken;
  }

 private:
  static constexpr bool chooses = (ChoosingRule<Rules> || ...);
  static constexpr bool switches = chooses || (SwitchingRule<Rules> || ...);
  static constexpr bool changes_mesh = (MeshRule<Rules> || ...);
  static constexpr bool sleeps = (SleepingRule<Rules> || ...);
  static_assert((0 + ... + int{SleepingRule<Rules>}) <= 1,
                "an Adaptation has at most one rule that puts patches to sleep");
  static_assert((0 + ... + int{ChoosingRule<Rules>}) <= 1,
                "an Adaptation has at most one rule that chooses: one of cheapest and within");
  static_assert(!chooses || ((ChoosingRule<Rules> || SleepingRule<Rules>)&&...),
                "cheapest and within choose for all elements of their groups: rules that switch or "
                "change the "
                "mesh go into another Adaptation");
  template <class R>
  static constexpr bool takes_means_by() {
    if constexpr (SleepingRule<R> || ChoosingRule<R>)
      return false;
    else
      return !std::same_as<
          typename detail::TakersOfMeans<decltype(R::criterion), typename R::from>::type,
          detail::TypeList<>>;
  }
  static constexpr bool takes_means = (takes_means_by<Rules>() || ...);
  template <class TheBody, class R>
  static constexpr bool acts_on() {
    if constexpr (SleepingRule<R>)
      return true;
    else if constexpr (ChoosingRule<R>)
      return TheBody::layout_type::template has<typename R::element>;
    else
      return TheBody::layout_type::template acts<typename R::from>;
  }

  /// What an integrator records of a look; lives on in the recording.
  class RecordedLook {
   public:
    explicit RecordedLook(Adaptation const& adapt) : adapt_(adapt) {}

    int interval() const { return adapt_.interval_; }
    std::shared_ptr<void const> const& identity() const { return adapt_.identity_; }
    /// Changes of the mesh, sleep and budgets in milliseconds pass through the host, means at nodes allocate, timers do
    /// not run in recordings, the host has to know of moves to stiffer laws; on the host nothing would be gained.
    template <class Parts>
    bool can_record(Parts const& parts) const {
      return !changes_mesh && !takes_means && !sleeps &&
             !std::same_as<typename Parts::backend_type::Recording, HostRecording> &&
             !parts.timers.criteria.timer && !parts.timers.migration.timer &&
             !adapt_.limits_milliseconds() && !adapt_.may_stiffen(parts);
    }
    template <class Parts>
    void prepare(Parts& parts) const {
      adapt_.prepare(parts);
      adapt_.begin_look(parts, 0);  // the clock
    }
    template <class Parts>
    void loop_over_look(Parts& parts) const {
      adapt_.begin_look(parts, adapt_.interval_);
      adapt_.decide(parts);
      if constexpr (switches) adapt_.switch_groups(parts);
    }

   private:
    Adaptation adapt_;
  };

  auto const& sleep_rule() const { return std::get<place_of({SleepingRule<Rules>...})>(rules_); }
  auto const& choosing_rule() const { return std::get<place_of({ChoosingRule<Rules>...})>(rules_); }
  /// Of the first that holds.
  static constexpr std::size_t place_of(std::initializer_list<bool> holds) {
    return static_cast<std::size_t>(std::find(holds.begin(), holds.end(), true) - holds.begin());
  }
  template <class Parts>
  LastLook& last_look(Parts& parts, std::int64_t first) const {
    auto& looks = parts.state.record.looks;
    auto const key = detail::look_key(parts.lookers, rules_key_, identity_);
    auto const found = std::ranges::find(looks, key, &LastLook::adaptation);
    return found != looks.end() ? *found : *looks.insert(found, {.adaptation = key, .step = first});
  }
  /// When the last call was at a step. A first one counts as made after a look.
  template <DeformableBody TheBody>
  int steps_to_look(TheBody& body, std::int64_t step) {
    auto const last = last_look(body.parts(), step).step;
    return static_cast<int>(std::max<std::int64_t>(1, last + interval_ - step));
  }

  template <class Parts>
  void prepare(Parts& parts) const {
    if (parts.clock.size() == 0) {
      parts.moves = zeros<double>(parts.backend, 1);
      parts.clock = zeros<std::int64_t>(parts.backend, 1);
    }
    for_each_check(parts, [](auto const& check) { check.prepare(); });
  }
  /// `later` steps after the last one; 0: now.
  template <class Parts>
  static void begin_look(Parts& parts, int later) {
    parts.backend.for_each(
        1, detail::BeginLook{parts.moves.data(), parts.clock.data(), later, parts.state.steps});
  }
  template <class Parts>
  void decide(Parts& parts) const {
    auto const measured = parts.timers.criteria.measure();
    for_each_check(parts, [](auto const& check) { check.decide(); });
  }

  template <class Parts, class Visit>
  void for_each_check(Parts& parts, Visit const& visit) const {
    parts.for_each_type([&](auto& table, auto& elements) {
      using Table = std::remove_cvref_t<decltype(table)>;
      using Elements = std::remove_cvref_t<decltype(elements)>;
      if constexpr (chooses) {
        using R = std::remove_cvref_t<decltype(choosing_rule())>;
        if constexpr (std::same_as<typename R::element, typename Table::element>)
          visit(detail::ChoiceCheck<Parts, Table, Elements, R>{
              parts, table, elements, choosing_rule(),
              detail::budget_now(choosing_rule(), last_look(parts, parts.state.steps))});
      } else {
        auto const rules = detail::rules_on<Table>(rules_);
        visit(detail::TableCheck<Parts, Table, Elements, std::remove_cvref_t<decltype(rules)>>{
            parts, table, elements, rules});
      }
    });
  }
  template <class Parts>
  void switch_groups(Parts& parts) const {
    bool const asks = asks_whether_to_switch(parts);
    if (asks && !something_moves(parts)) return;
    move_elements(parts);
    if (asks) follow_moves(parts);
  }
  /// What integrators keep follows the new groups. (Where the host does not know of moves, the integrator
  /// looks for stiffer elements when it looks at the distortion.)
  template <class Parts>
  static void follow_moves(Parts& parts) {
    parts.state.integrator.implicit.a.clear();
    follow_switch(parts);
  }
  /// Between the steps of leapfrog, and where no integrator has a step or accelerations, nothing follows from a
  /// switch at once but the elements' own: where the host would wait for the answer, and loops look at each
  /// tag as they go, it need not know, unless the integrator may have to follow before the next step.
  template <class Parts>
  bool asks_whether_to_switch(Parts const& parts) const {
    using B = typename Parts::backend_type;
    return B::orders_by_group || std::same_as<typename B::Recording, HostRecording> ||
           parts.forces_current || !parts.state.integrator.implicit.empty() || may_stiffen(parts) ||
           (parts.state.pending_half_kick == 0 && parts.state.integrator.step > 0);
  }
  /// Whether rules go to a law that is stiffer at rest by more than the safety of the step covers.
  template <class Parts>
  bool may_stiffen(Parts const& parts) const {
    auto const allowance = step_allowance(parts);
    if (!allowance) return false;
    auto const is_stiffer = [&]<class... From, class... To>(detail::TypeList<From...>,
                                                            detail::TypeList<To...>) {
      auto const young = [&]<class F>(Group<F> const& group) {
        return detail::young_at_rest(parts.template law_of<F>(), group);
      };
      return std::max({young(std::get<Group<To>>(parts.groups))...}) >
             allowance->growth * std::min({young(std::get<Group<From>>(parts.groups))...});
    };
    auto const stiffens = [&]<class R>(R const&) {
      if constexpr (SwitchingRule<R>)
        return is_stiffer(detail::TypeList<typename R::from>{}, detail::TypeList<typename R::to>{});
      else if constexpr (ChoosingRule<R>)
        return is_stiffer(typename R::groups{}, typename R::groups{});
      else
        return false;
    };
    return std::apply([&](auto const&... rule) { return (stiffens(rule) || ...); }, rules_);
  }
  template <class Parts>
  static bool something_moves(Parts const& parts) {
    return parts.backend.sum(1, detail::ValueAt<double>{parts.moves.data()}) != 0;
  }
  template <class Parts>
  void move_elements(Parts& parts) const {
    auto const allowance = step_allowance(parts);
    book_switching(parts, [&] {
      {
        auto const measured = parts.timers.criteria.measure();
        if (allowance) for_each_check(parts, [](auto const& check) { check.bound_movers(); });
        for_each_check(parts, [](auto const& check) { check.act(); });
      }
      regroup(parts);
    });
    if (allowance)
      for_each_check(parts, [&](auto const& check) { check.count_stiffened(*allowance); });
  }
  /// Call after tags changed.
  template <class Parts>
  static void regroup(Parts& parts) {
    if constexpr (Parts::backend_type::orders_by_group) {
      auto const measured = parts.timers.migration.measure();
      parts.for_each_type([&](auto& table, auto&) { table.elements.regroup(); });
    }
    forget_forces(parts);
  }
  /// What it has done; listeners are still to be told.
  template <class Parts>
  auto change_mesh(Parts& parts) const {
    int max_level = 0;
    MarkedElements marked;
    {
      auto const measured = parts.timers.criteria.measure();
      for_each_check(parts, [&](auto const& check) { check.mark(marked, max_level); });
    }
    auto const measured = parts.timers.migration.measure();
    auto plan = plan_change(parts, marked, max_level);
    if (plan) commit(parts, *plan);
    return plan;
  }

  /// Measures what steps have taken since the look before, where a budget is in milliseconds.
  template <class Parts>
  void take_time(Parts& parts) const {
    if (!limits_milliseconds()) return;
    double evaluations = 0;
    for_each_check(parts, [&](auto const& check) { evaluations += check.evaluations_now(); });
    auto& look = last_look(parts, parts.state.steps);
    detail::take_time(parts, choosing_rule(), detail::looker_of(parts.lookers, identity_),
                      evaluations, look);
  }
  template <class Parts>
  void start_time(Parts& parts) const {
    if (!limits_milliseconds()) return;
    auto& look = last_look(parts, parts.state.steps);
    detail::start_time(parts, choosing_rule(), detail::looker_of(parts.lookers, identity_), look);
  }
  bool limits_milliseconds() const {
    if constexpr (chooses)
      return std::isfinite(choosing_rule().milliseconds_per_step);
    else
      return false;
  }

  void set_interval(int calls) {
    if (calls < 1) throw Error("Adaptation.every: ", calls, " calls; give at least 1");
    interval_ = calls;
  }

  std::uint64_t rules_key_;
  std::shared_ptr<void const> identity_ = std::make_shared<char>();  // copies have the same rules
  std::tuple<Rules...> rules_;
  int interval_ = 8;
};

/// Lets body.parts().timers measure where the time of adaptation goes.
template <DeformableBody TheBody>
void measure_adaptation(TheBody& body) {
  auto& parts = body.parts();
  parts.timers.criteria.timer.emplace(parts.backend.timer());
  parts.timers.migration.timer.emplace(parts.backend.timer());
}

}  // namespace pliant
