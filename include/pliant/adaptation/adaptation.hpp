#pragma once

#include <algorithm>
#include <limits>
#include <memory>

#include <pliant/adaptation/look_at.hpp>
#include <pliant/adaptation/look_key.hpp>
#include <pliant/adaptation/sleep_look.hpp>
#include <pliant/adaptation/strategy.hpp>

namespace pliant {

/// Algorithm 1 of Caillaud et al. 2013, in parallel: at intervals, every rule's criterion is evaluated
/// for the elements of its formulation, and the elements that it marks act. Where several rules that
/// switch look at one formulation, the first that holds acts. Rules that switch go before rules that
/// refine or coarsen, which look at the groups after it, and these before one that puts patches to sleep. In sleeping patches
/// nothing switches. An element where a criterion is NaN does not act by that rule.
template <Rule... Rules>
class Adaptation {
 public:
  explicit Adaptation(Rules... rules)
      : rules_key_(detail::rules_key(rules...)), rules_{{std::move(rules)...}} {}

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
    call(body, Forces::as_they_are);
  }
  /// For integrators: the same, where the next step follows and takes the forces that the body then has.
  template <DeformableBody TheBody>
  void between_steps(TheBody& body) {
    call(body, Forces::of_next_step);
  }

  /// Looks and acts at once, whatever the interval. When it throws (the mesh would exceed the mesh's
  /// limits, a force term cannot be made anew, or a criterion throws on a backend that lets it), the body is
  /// as it was; but for what listeners throw, who are told when all is done.
  template <DeformableBody TheBody>
  void now(TheBody& body) {
    look(body, Forces::as_they_are);
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
    if constexpr (List::changes_mesh) {
      return 0;
    } else {
      auto& parts = body.parts();
      int const taken = take(RecordedLook{*this});
      if (taken > 0) last_look(parts, parts.state.steps).step = parts.state.steps;
      return taken;
    }
  }

 private:
  using List = detail::RuleList<Rules...>;
  /// Whether a look may evaluate forces, for the next step, that tell where to look.
  enum class Forces { as_they_are, of_next_step };

  template <DeformableBody TheBody>
  void call(TheBody& body, Forces forces) {
    if (steps_to_look(body, body.steps() - 1) > 1) return;
    look(body, forces);
    // Another mesh puts another state in place of the one that was looked at.
    last_look(body.parts(), body.steps()).step = body.steps();
  }
  template <DeformableBody TheBody>
  void look(TheBody& body, Forces forces) {
    static_assert(List::template act_on<TheBody>,
                  "a rule is for an element type that the body's mesh does not have");
    look_at_elements(body.parts(), forces);
  }
  template <class Parts>
  void look_at_elements(Parts& parts, Forces forces) const {
    look_at(parts).prepare();
    if (rules_.limits_milliseconds()) take_time(parts);
    auto const look = look_at(parts);  // with the budget of now
    look.begin(0);
    if constexpr (List::changes_mesh) {
      tell_listeners(parts, look.change());
    } else if constexpr (List::switches) {
      if (forces == Forces::of_next_step)
        look.switch_by_forces();
      else
        look.switch_groups();
    }
    if constexpr (List::sleeps) look_for_rest(parts, rules_.sleeping());
    if (rules_.limits_milliseconds()) start_time(parts);
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
      return !List::changes_mesh && !List::takes_means && !List::sleeps &&
             !std::same_as<typename Parts::backend_type::Recording, HostRecording> &&
             !parts.timers.criteria.timer && !parts.timers.migration.timer &&
             !adapt_.rules_.limits_milliseconds() && !adapt_.rules_.may_stiffen(parts);
    }
    template <class Parts>
    void prepare(Parts& parts) const {
      auto const look = adapt_.look_at(parts);
      look.prepare();
      look.begin(0);  // the clock
    }
    /// Whether the look evaluates the forces of the next step; see LookAt.
    template <class Parts>
    bool evaluates_forces(Parts& parts) const {
      return adapt_.look_at(parts).screens();
    }
    template <class Parts>
    void loop_over_look(Parts& parts) const {
      auto const look = adapt_.look_at(parts);
      look.begin(adapt_.interval_);
      if constexpr (List::switches) {
        if (look.screens())
          look.loop_by_forces();
        else
          look.switch_groups();
      }
    }

   private:
    Adaptation adapt_;
  };

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
  detail::LookAt<Parts, List> look_at(Parts& parts) const {
    double evaluations = std::numeric_limits<double>::quiet_NaN();
    if constexpr (List::chooses || List::holds_mesh)
      evaluations = detail::budget_now(limits(), last_look(parts, parts.state.steps));
    return {parts, rules_, evaluations};
  }

  /// What limits what a step takes.
  auto const& limits() const {
    if constexpr (List::holds_mesh)
      return rules_.holding().options;
    else
      return rules_.choosing();
  }
  /// Measures what steps have taken since the look before, where a budget is in milliseconds.
  template <class Parts>
  void take_time(Parts& parts) const {
    if constexpr (List::chooses || List::holds_mesh) {
      detail::take_time(parts, limits(), looker(parts), look_at(parts).evaluations_now(),
                        last_look(parts, parts.state.steps));
    }
  }
  template <class Parts>
  void start_time(Parts& parts) const {
    if constexpr (List::chooses || List::holds_mesh)
      detail::start_time(parts, limits(), looker(parts), last_look(parts, parts.state.steps));
  }
  template <class Parts>
  Looker& looker(Parts& parts) const {
    return detail::looker_of(parts.lookers, identity_);
  }

  void set_interval(int calls) {
    if (calls < 1) throw Error("Adaptation.every: ", calls, " calls; give at least 1");
    interval_ = calls;
  }

  std::uint64_t rules_key_;
  std::shared_ptr<void const> identity_ = std::make_shared<char>();  // copies have the same rules
  List rules_;
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
