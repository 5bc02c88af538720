#pragma once

#include <algorithm>
#include <limits>
#include <tuple>

#include <pliant/adaptation/criterion/criterion.hpp>

namespace pliant {

namespace detail {
enum class Extreme { largest, smallest };

template <Extreme X, class First, class... Rest>
struct ExtremeOf : SharedUnit<First, Rest...> {
  std::tuple<First, Rest...> criteria;

  explicit ExtremeOf(First first, Rest... rest) : criteria(first, rest...) {}

  double least_gradient(double threshold, int dim) const
    requires(X == Extreme::largest && BoundedCriterion<First> && (BoundedCriterion<Rest> && ...))
  {
    return std::apply(
        [&](auto const&... criterion) {
          return std::min({criterion.least_gradient(threshold, dim)...});
        },
        criteria);
  }
  /// All are below, so the one that tells most counts.
  double most_gradient(double threshold, int dim) const
    requires(X == Extreme::largest && BoundedCriterion<First> && (BoundedCriterion<Rest> && ...) &&
             (BoundedBelowCriterion<First> || ... || BoundedBelowCriterion<Rest>))
  {
    double most = std::numeric_limits<double>::infinity();
    auto const add = [&]<class C>(C const& criterion) {
      if constexpr (BoundedBelowCriterion<C>)
        most = std::min(most, criterion.most_gradient(threshold, dim));
    };
    std::apply([&](auto const&... criterion) { (add(criterion), ...); }, criteria);
    return most;
  }
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    return from<0>(e);
  }

 private:
  template <std::size_t I, class State>
  PLIANT_HOST_DEVICE auto from(State const& e) const {
    auto const value = value_of(std::get<I>(criteria), e);
    if constexpr (I == sizeof...(Rest))
      return value;
    else if constexpr (X == Extreme::largest)
      return maximum(value, from<I + 1>(e));
    else
      return minimum(value, from<I + 1>(e));
  }
};

template <Extreme X, class... Cs>
inline constexpr bool stateless<ExtremeOf<X, Cs...>> = (stateless<Cs> && ...);
}  // namespace detail

/// The largest of several criteria; NaN where one of them is.
template <class... Cs>
auto largest(Cs... criteria) {
  return detail::ExtremeOf<detail::Extreme::largest, Cs...>(criteria...);
}
/// The smallest of several criteria; NaN where one of them is.
template <class... Cs>
auto smallest(Cs... criteria) {
  return detail::ExtremeOf<detail::Extreme::smallest, Cs...>(criteria...);
}

}  // namespace pliant
