#pragma once

#include <functional>
#include <tuple>

#include <pliant/adaptation/criterion/criterion.hpp>

// Criteria that say their unit may be calculated with: 2.0 * VonMises{} - 1e5, EnergyDensity{} / StrainNorm{}.
namespace pliant {

namespace detail {

/// The same number everywhere.
struct Constant {
  double value;
  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const&) const {
    using S = typename State::scalar;
    return S(static_cast<builtin_scalar<S>>(value));
  }
};

enum class Operation { plus, minus, times, over };

/// A number has the unit of what it is added to.
template <Operation O, class A, class B>
constexpr Unit unit_of_result() {
  constexpr bool adds = O == Operation::plus || O == Operation::minus;
  if constexpr (std::same_as<B, Constant>) {
    return A::unit;
  } else if constexpr (std::same_as<A, Constant>) {
    return O == Operation::over ? Unit::other : B::unit;
  } else if constexpr (adds) {
    return A::unit;
  } else if constexpr (B::unit == Unit::one) {
    return A::unit;
  } else {
    return O == Operation::times && A::unit == Unit::one ? B::unit : Unit::other;
  }
}

template <Operation O, class A, class B>
inline constexpr bool adds_like_to_like = true;
template <Operation O, Measure A, Measure B>
  requires(O == Operation::plus || O == Operation::minus)
inline constexpr bool adds_like_to_like<O, A, B> = A::unit == B::unit;

template <Operation O, class A, class B>
struct Calculated {
  static constexpr Unit unit = unit_of_result<O, A, B>();
  static_assert(adds_like_to_like<O, A, B>,
                "criteria of different units are neither added nor subtracted");

  std::tuple<A, B> criteria;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    auto const a = value_of(std::get<0>(criteria), e), b = value_of(std::get<1>(criteria), e);
    if constexpr (O == Operation::plus)
      return a + b;
    else if constexpr (O == Operation::minus)
      return a - b;
    else if constexpr (O == Operation::times)
      return a * b;
    else
      return a / b;
  }
};
template <Operation O, class A, class B>
inline constexpr bool stateless<Calculated<O, A, B>> = stateless<A> && stateless<B>;

}  // namespace detail

template <Measure A, Measure B>
auto operator+(A a, B b) {
  return detail::Calculated<detail::Operation::plus, A, B>{{a, b}};
}
template <Measure A>
auto operator+(A a, detail::Number b) {
  return detail::Calculated<detail::Operation::plus, A, detail::Constant>{{a, {b.value}}};
}
template <Measure B>
auto operator+(detail::Number a, B b) {
  return detail::Calculated<detail::Operation::plus, detail::Constant, B>{{{a.value}, b}};
}
template <Measure A, Measure B>
auto operator-(A a, B b) {
  return detail::Calculated<detail::Operation::minus, A, B>{{a, b}};
}
template <Measure A>
auto operator-(A a, detail::Number b) {
  return detail::Calculated<detail::Operation::minus, A, detail::Constant>{{a, {b.value}}};
}
template <Measure B>
auto operator-(detail::Number a, B b) {
  return detail::Calculated<detail::Operation::minus, detail::Constant, B>{{{a.value}, b}};
}
template <Measure A, Measure B>
auto operator*(A a, B b) {
  return detail::Calculated<detail::Operation::times, A, B>{{a, b}};
}
template <Measure A>
auto operator*(A a, detail::Number b) {
  return detail::Calculated<detail::Operation::times, A, detail::Constant>{{a, {b.value}}};
}
template <Measure B>
auto operator*(detail::Number a, B b) {
  return detail::Calculated<detail::Operation::times, detail::Constant, B>{{{a.value}, b}};
}
template <Measure A, Measure B>
auto operator/(A a, B b) {
  return detail::Calculated<detail::Operation::over, A, B>{{a, b}};
}
template <Measure A>
auto operator/(A a, detail::Number b) {
  return detail::Calculated<detail::Operation::over, A, detail::Constant>{{a, {b.value}}};
}
template <Measure B>
auto operator/(detail::Number a, B b) {
  return detail::Calculated<detail::Operation::over, detail::Constant, B>{{{a.value}, b}};
}

}  // namespace pliant
