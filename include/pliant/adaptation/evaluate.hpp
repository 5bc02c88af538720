#pragma once

#include <pliant/adaptation/criteria_visitor.hpp>
#include <pliant/body/parts.hpp>

namespace pliant {

namespace detail {
/// Keeps the first value of each element.
template <class T>
struct Store {
  static constexpr int counters = 0;
  template <int>
  static constexpr bool bounded = false;
  T* values;  // (elements)
  template <int G, class V, class Again, class Tally>
  PLIANT_HOST_DEVICE void operator()(GroupNumber<G>, Index e, V const& own, Again const&,
                                     Tally const&) const {
    values[e] = own[0];
  }
};

/// Values of an array, those left out that are NaN, for sums.
template <class T>
struct KnownValue {
  T const* values;
  PLIANT_HOST_DEVICE double operator()(Index e) const {
    T const own = values[e];
    return own == own ? static_cast<double>(own) : 0;
  }
};

/// The value of a criterion for every element of a type by its internal number, in the backend's memory.
template <Element E, class Parts, class C>
auto values_on_backend(Parts const& parts, C const& criterion) {
  using T = typename Parts::T;
  auto const& table = parts.layout.template table<E>();
  using Table = std::remove_cvref_t<decltype(table)>;
  auto const rules = [&]<class... Fs>(TypeList<Fs...>) {
    static_assert((Criterion<C, Fs> && ...),
                  "evaluate: a criterion is called with the state of an element of each Group, and "
                  "gives a number");
    return TableRules<Table, Look<Fs, C>...>{{Look<Fs, C>{criterion}...}};
  }(typename Table::formulations{});
  auto values = zeros<T>(parts.backend, static_cast<std::size_t>(table.count()));
  CriteriaWorkspace<typename Parts::backend_type> workspace;
  evaluate_criteria(parts, table, active(table.elements), rules, workspace, Store<T>{values.data()},
                    parts.no_counters);
  return values;
}
/// By the user's, on the host.
template <Element E, class Parts, class C>
std::vector<double> evaluate_on(Parts const& parts, C const& criterion) {
  auto const internal = download<typename Parts::T>(values_on_backend<E>(parts, criterion));
  std::vector<double> in_user_order(internal.size());
  auto const& user = parts.layout.template table<E>().user_elements();
  for (std::size_t e = 0; e < internal.size(); ++e)
    in_user_order[static_cast<std::size_t>(user[e])] = static_cast<double>(internal[e]);
  return in_user_order;
}
}  // namespace detail

/// The value of a criterion for every element of a type, in the user's order, each under the
/// formulation that it has now.
template <Element E, class TheBody, class C>
std::vector<double> evaluate(TheBody const& body, C const& criterion) {
  return detail::evaluate_on<E>(body.parts(), criterion);
}

/// What an estimator estimates for a whole body, J: the sum over the elements of all types, those left out where it is
/// NaN. Its square root is the error in the energy norm over √2.
template <class TheBody, class C>
double estimate(TheBody const& body, C const& estimator) {
  static_assert(Measure<C>,
                "estimate: an estimator says `static constexpr Unit unit = Unit::joule;`");
  static_assert(C::unit == Unit::joule, "estimate: only what is in joules adds up over elements");
  double sum = 0;
  auto const& parts = body.parts();
  parts.for_each_type([&](auto const& table, auto const&) {
    using E = typename std::remove_cvref_t<decltype(table)>::element;
    auto const values = detail::values_on_backend<E>(parts, estimator);
    sum += parts.backend.sum(table.count(),
                             detail::KnownValue<typename TheBody::scalar>{values.data()});
  });
  return sum;
}

}  // namespace pliant
