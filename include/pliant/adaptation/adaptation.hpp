#pragma once

#include <pliant/adaptation/refinement.hpp>
#include <pliant/adaptation/strategy.hpp>
#include <pliant/adaptation/table_check.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/checksum.hpp>
#include <pliant/body/plain_type_name.hpp>

namespace pliant {

namespace detail {
struct SetZero {
  double* value;
  PLIANT_HOST_DEVICE void operator()(Index) const { *value = 0; }
};
}  // namespace detail

/// Algorithm 1 of Caillaud et al. 2013, in parallel: at intervals, every rule's criterion is evaluated
/// for the elements of its formulation, and the elements that it marks act. Where several rules that
/// switch look at one formulation, the first that holds acts. Rules that switch go before rules that
/// refine, which look at the groups after it. An element where a criterion is NaN does not act by that rule.
template <Rule... Rules>
class Adaptation {
 public:
  explicit Adaptation(Rules... rules) : key_(key_of(rules...)), rules_(std::move(rules)...) {}

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
  /// rolled back or loaded looks when the one before would have.
  template <DeformableBody TheBody>
  void operator()(TheBody& body) {
    auto const& state = body.state();
    auto& looks = body.parts().state.record.looks;
    auto last = std::ranges::find(looks, key_, &LastLook::adaptation);
    if (last == looks.end()) last = looks.insert(last, {key_, state.steps - 1});
    if (interval_ > 1 && state.steps - last->step < interval_) return;
    now(body);
    // A refinement puts another state in place of this one.
    std::ranges::find(looks, key_, &LastLook::adaptation)->step = state.steps;
  }

  /// Looks and acts at once, whatever the interval. When it throws (refinement would exceed the mesh's
  /// limits, a force term cannot be made anew, or a criterion throws on a backend that lets it), the body is
  /// as it was; but for what listeners throw, who are told when all is done.
  template <DeformableBody TheBody>
  void now(TheBody& body) {
    static_assert((TheBody::layout_type::template acts<typename Rules::from> && ...),
                  "a rule is for an element type that the body's mesh does not have");
    auto& parts = body.parts();
    parts.timers.criteria.start();
    if (parts.moves.size() == 0) parts.moves = zeros<double>(parts.backend, 1);
    parts.backend.for_each(1, detail::SetZero{parts.moves.data()});
    for_each_check(parts, [](auto const& check) { check.decide(); });
    parts.timers.criteria.stop();
    if constexpr (switches && refines) {
      for_each_check(parts, [](auto const& check) { check.keep(); });
      auto const plan = [&] {
        try {
          switch_groups(parts);
          return refine_marked(parts);
        } catch (...) {  // the mesh is the one of before
          for_each_check(parts, [](auto const& check) { check.put_back(); });
          regroup(parts);
          throw;
        }
      }();
      if (plan) tell_listeners(parts, *plan);
    } else if constexpr (switches) {
      switch_groups(parts);
    } else if constexpr (refines) {
      if (auto const plan = refine_marked(parts)) tell_listeners(parts, *plan);
    }
  }

 private:
  static constexpr bool switches = (SwitchingRule<Rules> || ...);
  static constexpr bool refines = (RefiningRule<Rules> || ...);

  template <class Parts, class Visit>
  void for_each_check(Parts& parts, Visit const& visit) const {
    parts.for_each_type([&](auto& table, auto& elements) {
      using Table = std::remove_cvref_t<decltype(table)>;
      using Elements = std::remove_cvref_t<decltype(elements)>;
      auto const rules = detail::rules_on<Table>(rules_);
      visit(detail::TableCheck<Parts, Table, Elements, std::remove_cvref_t<decltype(rules)>>{
          parts, table, elements, rules});
    });
  }
  template <class Parts>
  void switch_groups(Parts& parts) const {
    if (parts.backend.sum(1, detail::ValueAt<double>{parts.moves.data()}) == 0) return;
    parts.timers.criteria.start();
    evaluate_accelerations(parts);
    for_each_check(parts, [](auto const& check) { check.act(); });
    parts.timers.criteria.stop();
    regroup(parts);
    book_switching(parts);
  }
  /// Call after tags changed.
  template <class Parts>
  static void regroup(Parts& parts) {
    if constexpr (Parts::backend_type::orders_by_group) {
      parts.timers.migration.start();
      parts.for_each_type([&](auto& table, auto&) { table.elements.regroup(); });
      parts.timers.migration.stop();
    }
    forget_forces(parts);
  }
  /// What it has done; listeners are still to be told.
  template <class Parts>
  auto refine_marked(Parts& parts) const {
    parts.timers.criteria.start();
    int max_level = 0;
    std::vector<std::vector<Index>> marked;
    for_each_check(parts, [&](auto const& check) { marked.push_back(check.marked(max_level)); });
    parts.timers.criteria.stop();
    parts.timers.migration.start();
    auto plan = plan_refinement(parts, marked, max_level);
    if (plan) (void)commit(parts, *plan);
    parts.timers.migration.stop();
    return plan;
  }

  void set_interval(int calls) {
    if (calls < 1) throw Error("Adaptation.every: ", calls, " calls; give at least 1");
    interval_ = calls;
  }

  /// Tells rules of other types or numbers apart.
  static std::uint64_t key_of(Rules const&... rules) {
    std::string text;
    (name_rule(text, rules), ...);
    return checksum(text);
  }
  template <class TheRule>
  static void name_rule(std::string& text, TheRule const& rule) {
    text += detail::plain_type_name<TheRule>();
    double const numbers[] = {rule.marking.amount, rule.marking.floor,
                              static_cast<double>(rule.marking.budget)};
    for (double number : numbers) {
      text += ' ';
      detail::MessagePiece(number).add_to(text);
    }
  }

  std::uint64_t key_;  // of the last look in a body's record
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
