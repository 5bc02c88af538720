#pragma once

#include <pliant/math/dual_number.hpp>

// Comparisons and functions of dual numbers.
namespace pliant {

/// Comparisons look at values only.
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr auto operator<(Dual<T, N, Z> const& x, Dual<T, N, Z> const& y) {
  return x.value < y.value;
}
template <class T, int N, Zeros Z, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr auto operator<(Dual<T, N, Z> const& x, C const& c) {
  return x.value < T(c);
}
template <class Condition, class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> select(Condition const& condition,
                                                  Dual<T, N, Z> const& x, Dual<T, N, Z> const& y) {
  auto const both = [&](T const& a, T const& b) PLIANT_INLINE { return select(condition, a, b); };
  if constexpr (Z == Zeros::known) {
    return detail::combined(
        both(x.value, y.value), x, y, both, [&](T const& a) PLIANT_INLINE { return both(a, T(0)); },
        [&](T const& b) PLIANT_INLINE { return both(T(0), b); });
  } else {
    Dual<T, N> z;
    z.value = both(x.value, y.value);
    for (int k = 0; k < N; ++k) z.derivative[k] = both(x.derivative[k], y.derivative[k]);
    return z;
  }
}

template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> square(Dual<T, N, Z> const& x) {
  return x.chain(x.value * x.value, x.value + x.value);
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> square_of_positive(Dual<T, N, Z> const& x) {
  T const part = max(x.value, T(0));
  return x.chain(part * part, part + part);
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> positive_or_nan(Dual<T, N, Z> x) {
  x.value = positive_or_nan(x.value);
  return x;
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> sqrt(Dual<T, N, Z> const& x) {
  T const root = sqrt(x.value);
  return x.chain(root, T(1) / (T(2) * root));
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> log(Dual<T, N, Z> const& x) {
  return x.chain(log(x.value), T(1) / x.value);
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> log1p(Dual<T, N, Z> const& x) {
  return x.chain(log1p(x.value), T(1) / (T(1) + x.value));
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> exp(Dual<T, N, Z> const& x) {
  T const power = exp(x.value);
  return x.chain(power, power);
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> expm1(Dual<T, N, Z> const& x) {
  return x.chain(expm1(x.value), exp(x.value));  // where only the slope counts, exp alone is left
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> cbrt(Dual<T, N, Z> const& x) {
  T const root = cbrt(x.value);
  return x.chain(root, T(1) / (T(3) * root * root));
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> abs(Dual<T, N, Z> const& x) {
  return select(x.value < T(0), -x, x);
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> excess_of_log1p(Dual<T, N, Z> const& x) {
  return x.chain(excess_of_log1p(x.value), x.value * (T(1) / (T(1) + x.value)));
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> excess_of_expm1(Dual<T, N, Z> const& x) {
  return x.chain(excess_of_expm1(x.value), expm1(x.value));
}

}  // namespace pliant
