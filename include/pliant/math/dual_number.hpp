#pragma once

#include <pliant/math/functions.hpp>
#include <pliant/math/unroll.hpp>

namespace pliant {

/// Whether a dual number knows which of its derivatives are zero because its value depends on nothing that they are
/// along. Compilers do not drop what is multiplied by a zero, since the other factor may be no number. Worth it for a
/// few numbers, as the invariants of a tensor: in the entries of a tensor compilers lose sight of what is known.
enum class Zeros { unknown, known };

template <class T, int N, Zeros Z>
struct Dual;

namespace detail {
template <class T, int N, Zeros Z>
struct Derivatives {
  using type = T[N];
};
/// Derivatives of which those never written to are zero.
template <class T, int N>
class SomeDerivatives {
 public:
  PLIANT_HOST_DEVICE constexpr T const& operator[](int k) const { return values_[k]; }
  PLIANT_HOST_DEVICE constexpr T& operator[](int k) {
    written_[k] = true;
    return values_[k];
  }
  PLIANT_HOST_DEVICE constexpr bool may_differ_from_zero(int k) const { return written_[k]; }

 private:
  T values_[N]{};
  bool written_[N]{};
};
template <class T, int N>
struct Derivatives<T, N, Zeros::known> {
  using type = SomeDerivatives<T, N>;
};
}  // namespace detail

/// A value and its derivatives along N directions: forward automatic differentiation. T may be a
/// built-in scalar, a pack of elements, or a dual number again (second derivatives).
template <class T, int N, Zeros Z = Zeros::unknown>
struct Dual {
  T value{};
  typename detail::Derivatives<T, N, Z>::type derivative{};

  constexpr Dual() = default;

  /// A constant: its derivatives are zero.
  template <class C>
    requires std::constructible_from<T, C const&>
  PLIANT_HOST_DEVICE constexpr Dual(C const& constant) : value(static_cast<T>(constant)) {}

  /// The same number, of which is known that it depends on all, or no longer which zeros it has.
  PLIANT_HOST_DEVICE constexpr explicit Dual(
      Dual<T, N, Z == Zeros::known ? Zeros::unknown : Zeros::known> const& x)
      : value(x.value) {
    unroll<N>([&](auto k) PLIANT_INLINE { derivative[k] = x.derivative[k]; });
  }

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
    if constexpr (Z == Zeros::unknown) {
      for (int k = 0; k < N; ++k) y.derivative[k] = slope * derivative[k];
    } else {
      unroll<N>([&](auto k) PLIANT_INLINE {
        if (derivative.may_differ_from_zero(k)) y.derivative[k] = slope * derivative[k];
      });
    }
    return y;
  }
};

namespace detail {
/// A value whose derivatives are both(x', y'), or of_x(x') and of_y(y') where the other is known to be zero.
template <class T, int N, class Both, class OfX, class OfY>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Zeros::known> combined(T const& value,
                                                               Dual<T, N, Zeros::known> const& x,
                                                               Dual<T, N, Zeros::known> const& y,
                                                               Both const& both, OfX const& of_x,
                                                               OfY const& of_y) {
  Dual<T, N, Zeros::known> z;
  z.value = value;
  unroll<N>([&](auto k) PLIANT_INLINE {
    bool const by_x = x.derivative.may_differ_from_zero(k),
               by_y = y.derivative.may_differ_from_zero(k);
    if (by_x && by_y)
      z.derivative[k] = both(x.derivative[k], y.derivative[k]);
    else if (by_x)
      z.derivative[k] = of_x(x.derivative[k]);
    else if (by_y)
      z.derivative[k] = of_y(y.derivative[k]);
  });
  return z;
}
}  // namespace detail

template <class T, int N, Zeros Z>
struct BuiltinScalar<Dual<T, N, Z>> : BuiltinScalar<T> {};

/// What takes part in an expression with duals as a constant.
template <class C, class T>
concept ConstantFor = std::constructible_from<T, C const&>;

template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator-(Dual<T, N, Z> const& x) {
  return x.chain(-x.value, T(-1));
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator+(Dual<T, N, Z> const& x,
                                                     Dual<T, N, Z> const& y) {
  if constexpr (Z == Zeros::known) {
    return detail::combined(
        x.value + y.value, x, y, [](T const& a, T const& b) PLIANT_INLINE { return a + b; },
        [](T const& a) PLIANT_INLINE { return a; }, [](T const& b) PLIANT_INLINE { return b; });
  } else {
    Dual<T, N> z;
    z.value = x.value + y.value;
    for (int k = 0; k < N; ++k) z.derivative[k] = x.derivative[k] + y.derivative[k];
    return z;
  }
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator-(Dual<T, N, Z> const& x,
                                                     Dual<T, N, Z> const& y) {
  if constexpr (Z == Zeros::known) {
    return detail::combined(
        x.value - y.value, x, y, [](T const& a, T const& b) PLIANT_INLINE { return a - b; },
        [](T const& a) PLIANT_INLINE { return a; }, [](T const& b) PLIANT_INLINE { return -b; });
  } else {
    Dual<T, N> z;
    z.value = x.value - y.value;
    for (int k = 0; k < N; ++k) z.derivative[k] = x.derivative[k] - y.derivative[k];
    return z;
  }
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator*(Dual<T, N, Z> const& x,
                                                     Dual<T, N, Z> const& y) {
  auto const of_x = [&](T const& a) PLIANT_INLINE { return a * y.value; };
  auto const of_y = [&](T const& b) PLIANT_INLINE { return x.value * b; };
  auto const of_both = [&](T const& a, T const& b) PLIANT_INLINE { return of_x(a) + of_y(b); };
  if constexpr (Z == Zeros::known) {
    return detail::combined(x.value * y.value, x, y, of_both, of_x, of_y);
  } else {
    Dual<T, N> z;
    z.value = x.value * y.value;
    for (int k = 0; k < N; ++k)
      z.derivative[k] = x.derivative[k] * y.value + x.value * y.derivative[k];
    return z;
  }
}
template <class T, int N, Zeros Z>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator/(Dual<T, N, Z> const& x,
                                                     Dual<T, N, Z> const& y) {
  T const inverse = T(1) / y.value;
  if constexpr (Z == Zeros::known) {
    T const quotient = x.value * inverse;
    return detail::combined(
        quotient, x, y,
        [&](T const& a, T const& b) PLIANT_INLINE { return (a - quotient * b) * inverse; },
        [&](T const& a) PLIANT_INLINE { return a * inverse; },
        [&](T const& b) PLIANT_INLINE { return -quotient * b * inverse; });
  } else {
    Dual<T, N> z;
    z.value = x.value * inverse;
    for (int k = 0; k < N; ++k)
      z.derivative[k] = (x.derivative[k] - z.value * y.derivative[k]) * inverse;
    return z;
  }
}

/// The factor of which zeros are known stands first.
template <class T, int N>
PLIANT_HOST_DEVICE constexpr Dual<T, N> operator*(Dual<T, N, Zeros::known> const& x,
                                                  Dual<T, N> const& y) {
  Dual<T, N> z;
  z.value = x.value * y.value;
  unroll<N>([&](auto k) PLIANT_INLINE {
    z.derivative[k] = x.value * y.derivative[k];
    if (x.derivative.may_differ_from_zero(k))
      z.derivative[k] = z.derivative[k] + x.derivative[k] * y.value;
  });
  return z;
}

template <class T, int N, Zeros Z, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator+(Dual<T, N, Z> x, C const& c) {
  x.value = x.value + T(c);
  return x;
}
template <class T, int N, Zeros Z, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator+(C const& c, Dual<T, N, Z> const& x) {
  return x + c;
}
template <class T, int N, Zeros Z, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator-(Dual<T, N, Z> x, C const& c) {
  x.value = x.value - T(c);
  return x;
}
template <class T, int N, Zeros Z, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator-(C const& c, Dual<T, N, Z> const& x) {
  return x.chain(T(c) - x.value, T(-1));
}
template <class T, int N, Zeros Z, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator*(Dual<T, N, Z> const& x, C const& c) {
  return x.chain(x.value * T(c), T(c));
}
template <class T, int N, Zeros Z, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator*(C const& c, Dual<T, N, Z> const& x) {
  return x * c;
}
template <class T, int N, Zeros Z, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator/(Dual<T, N, Z> const& x, C const& c) {
  if constexpr (Arithmetic<C>)  // one division for all lanes of a pack, none for a literal
    return x * (1 / static_cast<builtin_scalar<T>>(c));
  else
    return x * (T(1) / T(c));
}
template <class T, int N, Zeros Z, ConstantFor<T> C>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z> operator/(C const& c, Dual<T, N, Z> const& x) {
  T const inverse = T(1) / x.value, quotient = T(c) * inverse;  // a division that others may share
  return x.chain(quotient, -quotient * inverse);
}

template <class T, int N, Zeros Z, class Y>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z>& operator+=(Dual<T, N, Z>& x, Y const& y) {
  return x = x + y;
}
template <class T, int N, Zeros Z, class Y>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z>& operator-=(Dual<T, N, Z>& x, Y const& y) {
  return x = x - y;
}
template <class T, int N, Zeros Z, class Y>
PLIANT_HOST_DEVICE constexpr Dual<T, N, Z>& operator*=(Dual<T, N, Z>& x, Y const& y) {
  return x = x * y;
}

}  // namespace pliant
