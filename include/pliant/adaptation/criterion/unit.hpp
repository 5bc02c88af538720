#pragma once

#include <concepts>

namespace pliant {

/// What the numbers of a criterion are. A criterion that says so, `static constexpr Unit unit = Unit::one;`, may be
/// calculated with and compared; one in joules is an estimator.
enum class Unit {
  one,
  metre,
  newton,
  pascal,
  joule,
  joule_per_volume,  ///< J/m³
  other              ///< of products and quotients
};

/// A functor that says what its numbers are.
template <class C>
concept Measure = requires {
  { C::unit } -> std::convertible_to<Unit>;
};

namespace detail {
/// The unit that several criteria share; `other` where they differ. Nothing where one does not say its own.
template <class... Cs>
struct SharedUnit {};
template <Measure First, Measure... Rest>
struct SharedUnit<First, Rest...> {
  static constexpr Unit unit = ((First::unit == Rest::unit) && ...) ? First::unit : Unit::other;
};
}  // namespace detail

}  // namespace pliant
