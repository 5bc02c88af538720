#pragma once

#include <concepts>

namespace pliant {

/// What the numbers of a criterion are. A criterion that says so, `static constexpr Unit unit = Unit::one;`, may be
/// calculated with and compared; one in joules is an estimator.
enum class Unit {
  one,
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

}  // namespace pliant
