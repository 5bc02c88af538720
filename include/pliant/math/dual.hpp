#pragma once

#include <pliant/math/functions.hpp>

namespace pliant {

/// A value and its derivatives along N directions: forward automatic differentiation. T may be a
/// built-in scalar, a pack of elements, or a dual number again (second derivatives).
template <class T, int N>
struct Dual {
  T value{};
  T derivative[N]{};

  constexpr Dual() = default;

  /// A constant: its derivatives are zero.
  template <class C>
    requires std::constructible_from<T, C const&>
  PLIANT_HOST_DEVICE constexpr Dual(C const& constant) : value(static_cast<T>(constant)) {}

  /// The variable number `direction`.
  PLIANT_HOST_DEVICE static constexpr Dual variable(T const& value, int direction) {
    Dual x(value);
    x.derivative[direction] = T(1);
    return x;
  }

  /// f(value), given f and f' there (the chain rule).
  PLIANT_HOST_DEVICE constexpr Dual chain(T const& f, T const& slope) const {
    Dual y;
    y.value = f;
    for (int k = 0; k < N; ++k) y.derivative[k] = slope * derivative[k];
    return y;
  }
};

template <class T, int N>
struct BuiltinScalar<Dual<T, N>> : BuiltinScalar<T> {};

/// What takes part in an expression with duals as a constant.
template <class C, class T>
concept ConstantFor = std::constructible_from<T, C const&>;

template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator-(Dual<T, N> const& x) {
  return x.chain(-x.value, T(-1));
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator+(Dual<T, N> const& x, Dual<T, N> const& y) {
  Dual<T, N> z;
  z.value = x.value + y.value;
  for (int k = 0; k < N; ++k) z.derivative[k] = x.derivative[k] + y.derivative[k];
  return z;
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator-(Dual<T, N> const& x, Dual<T, N> const& y) {
  Dual<T, N> z;
  z.value = x.value - y.value;
  for (int k = 0; k < N; ++k) z.derivative[k] = x.derivative[k] - y.derivative[k];
  return z;
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator*(Dual<T, N> const& x, Dual<T, N> const& y) {
  Dual<T, N> z;
  z.value = x.value * y.value;
  for (int k = 0; k < N; ++k)
    z.derivative[k] = x.derivative[k] * y.value + x.value * y.derivative[k];
  return z;
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator/(Dual<T, N> const& x, Dual<T, N> const& y) {
  T const inverse = T(1) / y.value;
  Dual<T, N> z;
  z.value = x.value * inverse;
  for (int k = 0; k < N; ++k)
    z.derivative[k] = (x.derivative[k] - z.value * y.derivative[k]) * inverse;
  return z;
}

template <class T, int N, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator+(Dual<T, N> x, C const& c) {
  x.value = x.value + T(c);
  return x;
}
template <class T, int N, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator+(C const& c, Dual<T, N> const& x) {
  return x + c;
}
template <class T, int N, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator-(Dual<T, N> x, C const& c) {
  x.value = x.value - T(c);
  return x;
}
template <class T, int N, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator-(C const& c, Dual<T, N> const& x) {
  return x.chain(T(c) - x.value, T(-1));
}
template <class T, int N, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator*(Dual<T, N> const& x, C const& c) {
  return x.chain(x.value * T(c), T(c));
}
template <class T, int N, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator*(C const& c, Dual<T, N> const& x) {
  return x * c;
}
template <class T, int N, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator/(Dual<T, N> const& x, C const& c) {
  if constexpr (Arithmetic<C>)  // one division for all lanes of a pack, none for a literal
    return x * (1 / static_cast<builtin_scalar<T>>(c));
  else
    return x * (T(1) / T(c));
}
template <class T, int N, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator/(C const& c, Dual<T, N> const& x) {
  T const quotient = T(c) / x.value;
  return x.chain(quotient, -quotient / x.value);
}

template <class T, int N, class Y>
PLIANT_HOST_DEVICE constexpr Dual<T, N>& operator+=(Dual<T, N>& x, Y const& y) {
  return x = x + y;
}
template <class T, int N, class Y>
PLIANT_HOST_DEVICE constexpr Dual<T, N>& operator-=(Dual<T, N>& x, Y const& y) {
  return x = x - y;
}
template <class T, int N, class Y>
PLIANT_HOST_DEVICE constexpr Dual<T, N>& operator*=(Dual<T, N>& x, Y const& y) {
  return x = x * y;
}

/// Comparisons look at values only.
template <class T, int N>
PLIANT_HOST_DEVICE constexpr auto operator<(Dual<T, N> const& x, Dual<T, N> const& y) {
  return x.value < y.value;
}
template <class T, int N, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr auto operator<(Dual<T, N> const& x, C const& c) {
  return x.value < T(c);
}
template <class Condition, class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> select(Condition const& condition, Dual<T, N> const& x,
                                               Dual<T, N> const& y) {
  Dual<T, N> z;
  z.value = select(condition, x.value, y.value);
  for (int k = 0; k < N; ++k) z.derivative[k] = select(condition, x.derivative[k], y.derivative[k]);
  return z;
}

template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> square(Dual<T, N> const& x) {
  return x.chain(x.value * x.value, x.value + x.value);
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> square_of_positive(Dual<T, N> const& x) {
  T const part = max(x.value, T(0));
  return x.chain(part * part, part + part);
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> positive_or_nan(Dual<T, N> x) {
  x.value = positive_or_nan(x.value);
  return x;
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> sqrt(Dual<T, N> const& x) {
  T const root = sqrt(x.value);
  return x.chain(root, T(1) / (T(2) * root));
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> log(Dual<T, N> const& x) {
  return x.chain(log(x.value), T(1) / x.value);
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> log1p(Dual<T, N> const& x) {
  return x.chain(log1p(x.value), T(1) / (T(1) + x.value));
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> exp(Dual<T, N> const& x) {
  T const power = exp(x.value);
  return x.chain(power, power);
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> expm1(Dual<T, N> const& x) {
  return x.chain(expm1(x.value), exp(x.value));  // where only the slope counts, exp alone is left
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> cbrt(Dual<T, N> const& x) {
  T const root = cbrt(x.value);
  return x.chain(root, T(1) / (T(3) * root * root));
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> abs(Dual<T, N> const& x) {
  return select(x.value < T(0), -x, x);
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> excess_of_log1p(Dual<T, N> const& x) {
  return x.chain(excess_of_log1p(x.value), x.value / (T(1) + x.value));
}
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> excess_of_expm1(Dual<T, N> const& x) {
  return x.chain(excess_of_expm1(x.value), expm1(x.value));
}

}  // namespace pliant
