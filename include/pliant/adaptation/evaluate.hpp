#pragma once

#include <pliant/adaptation/switching.hpp>

namespace pliant {

namespace detail {
/// A criterion of every element, each under the formulation that it has now.
template <class Table, class Criterion>
struct EvaluateVisitor {
  using T = typename Table::scalar;
  static constexpr int counters = 1;
  static constexpr bool reads_elements = Table::Laws::reads_elements;
  typename Table::Laws groups;
  Criterion criterion;
  T* values;  // (elements)

  template <int G, class... V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const&... v) const {
    return groups.template apply<G>(
        [this](auto const& law, auto const& rest, auto const& u) PLIANT_INLINE {
          return Vector<std::remove_cvref_t<decltype(rest(0, 0))>, 1>{
              {{criterion(state_of<typename Table::template formulation<G>>(law, rest, u))}}};
        },
        v...);
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const& value, Again const&,
                                 Tally const&) const {
    values[e] = value[0];
  }
};
}  // namespace detail

/// The value of a criterion for every element of a type, in the user's order.
template <Element E, class TheBody, class Criterion>
std::vector<double> evaluate(TheBody const& body, Criterion const& criterion) {
  auto const& parts = body.parts();
  using T = typename TheBody::scalar;
  auto const& table = parts.layout.template table<E>();
  using Table = std::remove_cvref_t<decltype(table)>;
  auto values = zeros<T>(parts.backend, static_cast<std::size_t>(table.count()));
  parts.backend.template visit<Table::groups>(
      table.elements,
      detail::EvaluateVisitor<Table, Criterion>{table.laws, criterion, values.data()},
      parts.no_counters, parts.rest(), parts.u());
  auto const internal = download<T>(values);
  std::vector<double> in_user_order(internal.size());
  for (std::size_t e = 0; e < internal.size(); ++e)
    in_user_order[static_cast<std::size_t>(table.user_element[e])] =
        static_cast<double>(internal[e]);
  return in_user_order;
}

}  // namespace pliant
