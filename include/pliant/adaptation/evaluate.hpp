#pragma once

#include <pliant/adaptation/switching.hpp>

namespace pliant {

namespace detail {
/// A criterion of every element, each under the formulation that it has now.
template <class Table, class Criterion>
struct EvaluateVisitor {
  using T = typename Table::scalar;
  static constexpr int counters = 1;
  typename Table::Laws groups;
  Criterion criterion;
  T* values;  // (elements)

  template <int G, class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const& rest, V const& u) const {
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    auto const& law = groups.template law<G>();
    using L = std::remove_cvref_t<decltype(law)>;
    Vector<S, 1> value;
    value[0] = criterion(ElementState<typename Table::template formulation<G>, L, S>{law, rest, u});
    return value;
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
  using B = typename TheBody::backend_type;
  using T = typename TheBody::scalar;
  auto const& table = body.layout().template table<E>();
  using Table = std::remove_cvref_t<decltype(table)>;
  typename B::template Array<T> values(static_cast<std::size_t>(table.count()));
  typename B::template Array<double> counters(1);
  body.backend().template visit<Table::groups>(
      table.elements,
      detail::EvaluateVisitor<Table, Criterion>{table.laws, criterion, values.data()}, counters,
      body.rest_field(), body.displacement_field());
  auto const internal = download<T>(values);
  std::vector<double> in_user_order(internal.size());
  for (std::size_t e = 0; e < internal.size(); ++e)
    in_user_order[static_cast<std::size_t>(table.user_element[e])] =
        static_cast<double>(internal[e]);
  return in_user_order;
}

}  // namespace pliant
