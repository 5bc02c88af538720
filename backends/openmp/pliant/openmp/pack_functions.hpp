#pragma once

#include <bit>
#include <limits>

#include <pliant/openmp/pack.hpp>

// The elementary functions of packs, to a few units in the last place. In plain vector operations, with
// no call and no detour through memory: a compiler then drops what is not used and what it has already.
namespace pliant {

namespace detail {

/// How a scalar is stored.
template <class T>
struct Bits {
  static constexpr int mantissa = std::numeric_limits<T>::digits - 1;
  static constexpr int bias = std::numeric_limits<T>::max_exponent - 1;
  static constexpr T ln2_high = T(sizeof(T) == 4 ? 0.693359375 : 6.93145751953125e-1);
  static constexpr T ln2_low = T(sizeof(T) == 4 ? -2.12194440054690583e-4 : 1.42860682030941723e-6);
};

template <class T, int L>
PLIANT_HOST_DEVICE typename Pack<T, L>::Mask bits_of(Pack<T, L> const& x) {
  return std::bit_cast<typename Pack<T, L>::Mask>(x.v);
}
/// a − b, which may wrap around.
template <class T, int L>
PLIANT_HOST_DEVICE typename Pack<T, L>::Mask wrapped_difference(
    typename Pack<T, L>::Mask const& a, typename Pack<T, L>::Mask const& b) {
  using Integer = std::make_unsigned_t<typename Pack<T, L>::Integer>;
  typedef Integer Unsigned __attribute__((vector_size(sizeof(T) * L)));
  return std::bit_cast<typename Pack<T, L>::Mask>(std::bit_cast<Unsigned>(a) -
                                                  std::bit_cast<Unsigned>(b));
}
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> with_bits(typename Pack<T, L>::Mask const& bits) {
  return {std::bit_cast<typename Pack<T, L>::Register>(bits)};
}
/// 2ⁿ
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> power_of_two(typename Pack<T, L>::Mask const& n) {
  return with_bits<T, L>((n + Bits<T>::bias) << Bits<T>::mantissa);
}

/// eˣ = 2ⁿ (1 + rest), x = n ln 2 + r, rest = eʳ − 1 by Taylor's series, |r| < 0.35.
template <class T, int L>
struct SplitExponential {
  using P = Pack<T, L>;
  typedef std::int32_t Integers __attribute__((vector_size(4 * L)));
  typename P::Mask n;
  P rest;

  PLIANT_HOST_DEVICE explicit SplitExponential(P x) {
    constexpr T most = T(sizeof(T) == 4 ? 104 : 746);  // overflows, and underflows to 0
    x = select(x < P(-most), P(-most), select(P(most) < x, P(most), x));
    P const turns = P(T(1.4426950408889634)) * x;
    P const nearest = turns + select(turns < P(0), P(T(-0.5)), P(T(0.5)));
    Integers const whole = __builtin_convertvector(nearest.v, Integers);
    P const n_real{__builtin_convertvector(whole, typename P::Register)};
    n = __builtin_convertvector(whole, typename P::Mask);
    P const r = x - n_real * P(Bits<T>::ln2_high) - n_real * P(Bits<T>::ln2_low);
    // Even and odd terms apart, two shorter chains of operations that wait for each other.
    constexpr int degree = sizeof(T) == 4 ? 7 : 13;
    P const r2 = r * r;
    P odd = P(inverse_factorial(degree)), even = P(inverse_factorial(degree - 1));
    for (int k = degree - 2; k >= 3; k -= 2) {
      odd = odd * r2 + P(inverse_factorial(k));
      even = even * r2 + P(inverse_factorial(k - 1));
    }
    rest = r + r2 * (even + r * odd);
  }
  PLIANT_HOST_DEVICE P whole() const {  // in two steps, as 2ⁿ alone may not be a number
    auto const half = n >> 1;
    return (P(1) + rest) * power_of_two<T, L>(half) * power_of_two<T, L>(n - half);
  }

 private:
  PLIANT_HOST_DEVICE static constexpr T inverse_factorial(int k) {
    double f = 1;
    for (int i = 2; i <= k; ++i) f *= i;
    return T(1 / f);
  }
};

/// x = 2ᵉ (1 + f), f between √½ − 1 and √2 − 1; for normal positive numbers.
template <class T, int L>
struct SplitNumber {
  using P = Pack<T, L>;
  typename P::Mask e;
  P f;

  PLIANT_HOST_DEVICE explicit SplitNumber(P const& x) {
    constexpr auto root_half = std::bit_cast<typename P::Integer>(T(0.70710678118654752));
    auto const above = wrapped_difference<T, L>(bits_of(x), root_half - typename P::Mask{});
    e = above >> Bits<T>::mantissa;
    f = with_bits<T, L>(wrapped_difference<T, L>(bits_of(x), e << Bits<T>::mantissa)) - P(1);
  }
  /// ln x. With s = f/(2 + f), ln(1 + f) = 2 artanh s = f − f²/2 + s (f²/2 + R(s²)), R = Σ 2 s²ᵏ/(2k + 1), of which this
  /// is the best polynomial (Sun's fdlibm, e_log.c and its version for float).
  PLIANT_HOST_DEVICE P log() const {
    P const s = f / (P(2) + f), z = s * s, w = z * z, half = P(T(0.5)) * f * f;
    P even, odd;  // two shorter chains of operations that wait for each other
    if constexpr (sizeof(T) == 4) {
      odd = P(T(0.66666662693)) + w * P(T(0.28498786688));
      even = P(T(0.40000972152)) + w * P(T(0.24279078841));
    } else {
      odd = P(T(6.666666666666735130e-01)) +
            w * (P(T(2.857142874366239149e-01)) +
                 w * (P(T(1.818357216161805012e-01)) + w * P(T(1.479819860511658591e-01))));
      even = P(T(3.999999999940941908e-01)) +
             w * (P(T(2.222219843214978396e-01)) + w * P(T(1.531383769920937332e-01)));
    }
    P const sum = odd + z * even;
    P const e_real{__builtin_convertvector(e, typename P::Register)};
    P const low = s * (half + z * sum) + e_real * P(Bits<T>::ln2_low);
    return e_real * P(Bits<T>::ln2_high) + (f - (half - low));
  }
};

/// What a logarithm is where its argument y is no positive number.
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> or_limit_of_log(Pack<T, L> const& y, Pack<T, L> const& log) {
  using P = Pack<T, L>;
  using Limits = std::numeric_limits<T>;
  P const not_above = select(y < P(0), P(Limits::quiet_NaN()), P(-Limits::infinity()));
  P const above = select(y < P(Limits::infinity()), log, y);  // infinity, or no number
  return select(P(0) < y, above, select(y < P(Limits::min()), not_above, y));
}

}  // namespace detail

/// An instruction, since not every compiler makes one of the loop, and <immintrin.h> takes longer to
/// read than all headers of Pliant together.
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> sqrt(Pack<T, L> const& x) {
  Pack<T, L> root;
#if defined(__AVX__)
  if constexpr (sizeof(x.v) == simd_bytes) {
    if constexpr (sizeof(T) == 4)
      asm("vsqrtps %1, %0" : "=v"(root.v) : "v"(x.v));
    else
      asm("vsqrtpd %1, %0" : "=v"(root.v) : "v"(x.v));
    return root;
  }
#elif defined(__SSE2__)
  if constexpr (sizeof(x.v) == simd_bytes) {
    if constexpr (sizeof(T) == 4)
      asm("sqrtps %1, %0" : "=x"(root.v) : "x"(x.v));
    else
      asm("sqrtpd %1, %0" : "=x"(root.v) : "x"(x.v));
    return root;
  }
#endif
  for (int l = 0; l < L; ++l) root.v[l] = std::sqrt(x[l]);
  return root;
}
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> exp(Pack<T, L> const& x) {
  return detail::SplitExponential<T, L>(x).whole();
}
/// eˣ − 1 = 2ⁿ (eʳ − 1) + (2ⁿ − 1)
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> expm1(Pack<T, L> const& x) {
  using P = Pack<T, L>;
  detail::SplitExponential<T, L> const e(x);
  P const power = detail::power_of_two<T, L>(e.n);
  P const y = power * e.rest + (power - P(1));
  return select(x < P(T(-60)), P(-1), select(P(T(60)) < x, e.whole(), y));
}
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> log(Pack<T, L> const& x) {
  return detail::or_limit_of_log(x, detail::SplitNumber<T, L>(x).log());
}
/// ln y with y = 1 + x, and what the sum rounds away.
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> log1p(Pack<T, L> const& x) {
  using P = Pack<T, L>;
  P const y = P(1) + x, lost = select(P(1) < x, P(1) - (y - x), x - (y - P(1)));
  detail::SplitNumber<T, L> split(y);
  split.f = split.f + lost * detail::power_of_two<T, L>(-split.e);
  return detail::or_limit_of_log(y, split.log());
}
/// From an estimate of x^(−1/3) to 4%, read off the bits, by Newton's method, which needs no division
/// (Moroz, Samotyy, Walczyk and Cieslinski, Fast calculation of cube and inverse cube roots using a
/// magic constant and its implementation on microcontrollers, Energies 14 (2021) 1058).
template <class T, int L>
PLIANT_HOST_DEVICE Pack<T, L> cbrt(Pack<T, L> const& x) {
  using P = Pack<T, L>;
  using Integer = typename P::Integer;
  constexpr auto magic = static_cast<Integer>(sizeof(T) == 4 ? 0x548c39cb : 0x553ef0ff289dd796);
  P const size = abs(x);
  auto third = detail::bits_of(size) >> 2;  // times 5/4, 17/16, 257/256, ... makes 4/3 of that
  for (int shift = 2; shift <= 16; shift *= 2) third = third + (third >> shift);
  P inverse = detail::with_bits<T, L>(magic - third);
  constexpr int steps = sizeof(T) == 4 ? 3 : 4;
  for (int k = 0; k < steps; ++k) {
    P const error = P(1) - size * inverse * inverse * inverse;
    inverse = inverse + inverse * error * P(T(1.0 / 3));
  }
  P const square = inverse * inverse, root = size * square;
  P const better = root + (size - root * root * root) * square * P(T(1.0 / 3));
  return select(P(0) < size, select(x < P(0), -better, better), x);
}

}  // namespace pliant
