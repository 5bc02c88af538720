#pragma once

#include <pliant/adaptation/criteria_visitor.hpp>
#include <pliant/adaptation/lists_on.hpp>
#include <pliant/body/parts.hpp>

namespace pliant {

/// A strategy with an action of the user's own, as in Algorithm 1 of Caillaud et al. 2013: a functor for host and
/// device with
///   bool action_needed(T value) const
///   void action(Index element, T value) const
/// where `element` is the user's number. What actions share, arrays of the backend's memory say, is the user's.
template <class S, class T>
concept Strategy = std::copy_constructible<S> && requires(S const& s, Index element, T value) {
  { s.action_needed(value) } -> std::convertible_to<bool>;
  s.action(element, value);
};

namespace detail {
template <class T, int Group, class S>
struct TakeAction {
  static constexpr int counters = 0;
  template <int>
  static constexpr bool bounded = false;
  S strategy;
  Index const* number;  // (elements)

  template <int G, class V, class Again, class Tally>
  PLIANT_HOST_DEVICE void operator()(GroupNumber<G>, Index e, V const& own, Again const&,
                                     Tally const&) const {
    if constexpr (G == Group) {
      T const value = own[0];
      if (value == value && strategy.action_needed(value)) strategy.action(number[e], value);
    }
  }
};
}  // namespace detail

/// Takes a strategy's action for each element of the formulation F whose value of a criterion needs it, all in
/// parallel, in the backend's memory. Elements where it is NaN are passed over. The body stays as it is.
template <class F, DeformableBody TheBody, class C, class S>
void adapt(TheBody& body, C const& criterion, S const& strategy) {
  using T = typename TheBody::scalar;
  static_assert(TheBody::layout_type::template acts<F>,
                "adapt<F>: F is on an element type that the body's mesh does not have");
  static_assert(
      Criterion<C, F>,
      "adapt<F>: a criterion is called with the state of an element of F, and gives a number");
  static_assert(Strategy<S, T>,
                "adapt<F>: a strategy has action_needed(value) and action(element, value)");
  auto& parts = body.parts();
  auto& table = parts.layout.template table<typename F::element>();
  using Table = std::remove_cvref_t<decltype(table)>;
  auto& workspace = table.criteria;
  if (workspace.number.size() < static_cast<std::size_t>(table.count()))
    workspace.number = detail::numbers_on_backend(parts, table);
  detail::TableRules<Table, detail::Look<F, C>> const rules{{detail::Look<F, C>{criterion}}};
  detail::evaluate_criteria(
      std::as_const(parts), std::as_const(table), detail::active(std::as_const(table).elements),
      rules, workspace,
      detail::TakeAction<T, Table::template group_of<F>, S>{strategy, workspace.number.data()},
      parts.no_counters);
}

}  // namespace pliant
