#pragma once

#include <pliant/adaptation/refinement.hpp>
#include <pliant/adaptation/switching.hpp>

namespace pliant {

/// Algorithm 1 of Caillaud et al. 2013, in parallel: at intervals, every rule's criterion is evaluated
/// for the elements of its formulation, and the elements that it marks act. Where several rules look
/// at one formulation, the first that holds acts. Rules that switch go before rules that refine.
template <class... Rules>
class Adaptation {
 public:
  explicit Adaptation(Rules... rules) : rules_(std::move(rules)...) {}

  /// Looks at every n-th call only; 8 when not said.
  Adaptation&& every(int calls) && {
    set_interval(calls);
    return std::move(*this);
  }
  Adaptation& every(int calls) & {
    set_interval(calls);
    return *this;
  }
  /// Call after each step.
  template <class TheBody>
  void operator()(TheBody& body) {
    if (++calls_ % interval_ == 0) now(body);
  }

  /// Looks and acts at once, whatever the interval.
  template <class TheBody>
  void now(TheBody& body) {
    static_assert((TheBody::layout_type::template acts<typename Rules::from> && ...),
                  "a rule is for an element type that the body's mesh does not have");
    constexpr bool refines = (!detail::Switches<Rules> || ...);
    auto& parts = body.parts();
    auto& timers = parts.timers;
    timers.criteria.start();
    parts.for_each_type([&](auto& table, auto& elements) {
      using Table = std::remove_cvref_t<decltype(table)>;
      detail::switch_groups(parts, table, elements, switching<Table>());
    });
    timers.criteria.stop();
    if constexpr (TheBody::backend_type::orders_by_group) {
      timers.migration.start();
      parts.for_each_type([&](auto& table, auto&) { table.elements.regroup(); });
      timers.migration.stop();
    }
    forget_forces(parts);
    if constexpr (refines) {
      timers.criteria.start();
      int max_level = 0;
      std::vector<std::vector<Index>> marked;
      parts.for_each_type(
          [&](auto& table, auto&) { marked.push_back(marked_in(parts, table, max_level)); });
      timers.criteria.stop();
      timers.migration.start();
      refine(body, marked, max_level);
      timers.migration.stop();
    }
  }

 private:
  template <class Table>
  auto switching() const {
    return std::apply(
        [](auto const&... rule) { return std::tuple_cat(detail::only_switching<Table>(rule)...); },
        rules_);
  }

  /// The elements that rules want refined, by the user's number.
  template <class Parts, class Table>
  std::vector<Index> marked_in(Parts& parts, Table& table, int& max_level) const {
    std::vector<Index> marked;
    auto const look = [&](auto const& rule) {
      using Rule = std::remove_cvref_t<decltype(rule)>;
      if constexpr (!detail::Switches<Rule> && detail::On<Rule, Table>) {
        static_assert(Table::template group_of<typename Rule::from> < Table::groups,
                      "a rule names a formulation of which the body has no Group");
        auto const values = detail::criterion_values(parts, table, rule);
        auto const threshold =
            threshold_of(rule.marking, parts.backend, values.data(), table.count());
        auto const on_host = download<typename Parts::T>(values);
        auto const levels = detail::levels_of<typename Table::element>(parts);
        for (std::size_t e = 0; e < on_host.size(); ++e) {
          Index const element = table.user_element[e];
          bool const holds = rule.marking.below() ? on_host[e] < threshold : on_host[e] > threshold;
          if (holds && levels[static_cast<std::size_t>(element)] < rule.options.max_level)
            marked.push_back(element);
        }
        max_level = std::max(max_level, rule.options.max_level);
      }
    };
    std::apply([&](auto const&... rule) { (look(rule), ...); }, rules_);
    return marked;
  }

  void set_interval(int calls) {
    if (calls < 1) throw Error("Adaptation.every: ", calls, " calls; give at least 1");
    interval_ = calls;
  }

  std::tuple<Rules...> rules_;
  int interval_ = 8, calls_ = 0;
};

}  // namespace pliant
