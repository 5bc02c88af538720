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
/// A number beside a criterion. An operator of two plain numbers is an error for compilers that look at a declaration before
/// its constraints (clang++ 14), wherever namespace pliant is searched for one.
struct Number {
  double value;
  Number(double number) : value(number) {}
};

/// The unit that several criteria share; `other` where they differ. Nothing where one does not say its own.
template <class... Cs>
struct SharedUnit {};
template <Measure First, Measure... Rest>
struct SharedUnit<First, Rest...> {
  static constexpr Unit unit = ((First::unit == Rest::unit) && ...) ? First::unit : Unit::other;
};
}  // namespace detail

}  // namespace pliant
