#pragma once

#include <cmath>
#include <tuple>

#include <pliant/adaptation/criterion/criterion.hpp>
#include <pliant/error.hpp>

// Comparisons of criteria that say their unit, and what is made of them:
//   when<F>(all(VonMises{} > 1e5, Rotation{} < 0.1)).holds().become<G>()
// As criteria they are 1 where they hold and 0 elsewhere, NaN included.
namespace pliant {

namespace detail {

/// ±(criterion − limit) > 0.
template <class C>
struct Comparison {
  static constexpr bool is_condition = true;
  std::tuple<C> criteria;
  double limit, sign;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    using T = builtin_scalar<S>;
    S const own = S(static_cast<T>(sign)) * S(value_of(std::get<0>(criteria), e));
    return select(S(static_cast<T>(sign * limit)) < own, S(1), S(0));
  }
};

enum class Quantifier { all, any };
template <Quantifier Q, class... Cs>
struct Conditions {
  static constexpr bool is_condition = true;
  std::tuple<Cs...> criteria;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return from<0>(e);
  }

 private:
  template <std::size_t I, class State>
  PLIANT_HOST_DEVICE auto from(State const& e) const {
    auto const value = std::get<I>(criteria)(e);
    if constexpr (I + 1 == sizeof...(Cs))
      return value;
    else if constexpr (Q == Quantifier::all)
      return min(value, from<I + 1>(e));
    else
      return max(value, from<I + 1>(e));
  }
};

inline double limit(double value) {
  if (std::isnan(value)) throw Error("criterion: NaN is not a number to compare with; give one");
  return value;
}

}  // namespace detail

/// 1 where it holds, 0 elsewhere.
template <class C>
concept ElementCondition = requires { requires C::is_condition; };

template <Measure C>
auto operator>(C criterion, detail::Number limit) {
  return detail::Comparison<C>{{criterion}, detail::limit(limit.value), 1};
}
template <Measure C>
auto operator<(C criterion, detail::Number limit) {
  return detail::Comparison<C>{{criterion}, detail::limit(limit.value), -1};
}
template <Measure C>
auto operator<(detail::Number limit, C criterion) {
  return criterion > limit;
}
template <Measure C>
auto operator>(detail::Number limit, C criterion) {
  return criterion < limit;
}

/// Where each of several conditions holds.
template <ElementCondition... Cs>
auto all(Cs... conditions) {
  return detail::Conditions<detail::Quantifier::all, Cs...>{{conditions...}};
}
/// Where some condition holds.
template <ElementCondition... Cs>
auto any(Cs... conditions) {
  return detail::Conditions<detail::Quantifier::any, Cs...>{{conditions...}};
}

}  // namespace pliant
