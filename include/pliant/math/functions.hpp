#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <type_traits>

#include <pliant/config.hpp>

// The elementary functions that physics uses, for built-in scalars. Packs of elements and dual
// numbers overload the same names; physics calls them unqualified.
namespace pliant {

template <class T>
concept Arithmetic = std::is_arithmetic_v<T>;

/// The scalar in which a value's parts are stored: `float` for a pack of floats or their duals.
template <class T>
struct BuiltinScalar {
  using type = T;
};
template <class T>
using builtin_scalar = typename BuiltinScalar<T>::type;

template <std::floating_point T>
PLIANT_HOST_DEVICE T sqrt(T x) {
  return std::sqrt(x);
}
template <std::floating_point T>
PLIANT_HOST_DEVICE T log(T x) {
  return std::log(x);
}
template <std::floating_point T>
PLIANT_HOST_DEVICE T log1p(T x) {
  return std::log1p(x);
}
template <std::floating_point T>
PLIANT_HOST_DEVICE T exp(T x) {
  return std::exp(x);
}
template <std::floating_point T>
PLIANT_HOST_DEVICE T expm1(T x) {
  return std::expm1(x);
}
template <std::floating_point T>
PLIANT_HOST_DEVICE T cbrt(T x) {
  return std::cbrt(x);
}
template <std::floating_point T>
PLIANT_HOST_DEVICE T abs(T x) {
  return std::fabs(x);
}

/// a b + c, which every kernel rounds alike: once where the target has an instruction for it, else twice.
/// Compilers choose kernel by kernel how they round `a * b + c`; what two kernels must agree on is written so.
template <std::floating_point T>
PLIANT_HOST_DEVICE T multiply_add(T a, T b, T c) {
#if defined(__CUDA_ARCH__)
  return std::fma(a, b, c);
#else
  // A target without such an instruction has nothing to contract to.
#if defined(__FP_FAST_FMA)
  if constexpr (std::same_as<T, double>) return std::fma(a, b, c);
#endif
#if defined(__FP_FAST_FMAF)
  if constexpr (std::same_as<T, float>) return std::fma(a, b, c);
#endif
  return a * b + c;
#endif
}

/// `condition ? a : b`, evaluated without a branch on packs of elements.
template <Arithmetic T>
PLIANT_HOST_DEVICE constexpr T select(bool condition, T a, T b) {
  return condition ? a : b;
}

/// Whether a < b; of packs, whether it is so for some element.
template <Arithmetic T>
PLIANT_HOST_DEVICE constexpr bool any_less(T a, T b) {
  return a < b;
}

template <class T>
PLIANT_HOST_DEVICE T max(T const& a, T const& b) {
  return select(a < b, b, a);
}
template <class T>
PLIANT_HOST_DEVICE T min(T const& a, T const& b) {
  return select(b < a, b, a);
}
/// The larger and the smaller of two numbers; NaN where either is, as max and min are not.
template <class T>
PLIANT_HOST_DEVICE T maximum(T const& a, T const& b) {
  return select(b == b, max(a, b), b);
}
template <class T>
PLIANT_HOST_DEVICE T minimum(T const& a, T const& b) {
  return select(b == b, min(a, b), b);
}
/// 1 / x. On a GPU to the last bit or its neighbour, without the branch that an exact division takes for the sake of
/// numbers below 1e-38, or 1e-308 in double precision, where zero and infinity give NaN.
template <class T>
PLIANT_HOST_DEVICE T reciprocal(T const& x) {
#if defined(__CUDA_ARCH__)
  if constexpr (std::same_as<T, float>) {
    float y;
    asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(y) : "f"(x));
    return y;
  } else if constexpr (std::same_as<T, double>) {
    double y;  // to 20 bits, then doubled twice by Newton's iteration
    asm("rcp.approx.ftz.f64 %0, %1;" : "=d"(y) : "d"(x));
    y = fma(y, fma(-x, y, 1.0), y);
    return fma(y, fma(-x, y, 1.0), y);
  }
#endif
  return T(1) / x;
}
template <class T>
PLIANT_HOST_DEVICE T square(T const& x) {
  return x * x;
}
/// ⟨x⟩² with Macaulay's bracket ⟨x⟩ = max(x, 0): smooth where it begins.
template <class T>
PLIANT_HOST_DEVICE T square_of_positive(T const& x) {
  return square(max(x, T(0)));
}

template <class T>
PLIANT_HOST_DEVICE T not_a_number() {
  constexpr auto nan = std::numeric_limits<builtin_scalar<T>>::quiet_NaN();
  return T(nan);
}
/// x where it is positive, NaN elsewhere: for what is defined for positive numbers only, such as an
/// energy with 1/J². All that is computed from it is NaN then, derivatives included.
template <class T>
PLIANT_HOST_DEVICE T positive_or_nan(T const& x) {
  return select(T(0) < x, x, not_a_number<T>());
}

/// x − ln(1 + x), without the cancellation that the plain difference suffers for small x.
template <class T>
PLIANT_HOST_DEVICE T excess_of_log1p(T const& x) {
  // Truncation below 2e-17 relative to x²/2 for |x| < 1/16; beyond, the difference loses < 6 bits.
  T series = T(1) / T(14);
  for (int k = 13; k >= 2; --k) series = T(1) / T(k) - x * series;
  return select(abs(x) < T(0.0625), x * x * series, x - log1p(x));
}

/// eˣ − 1 − x, without the cancellation that the plain difference suffers for small x.
template <class T>
PLIANT_HOST_DEVICE T excess_of_expm1(T const& x) {
  // Truncation below 1e-18 relative to x²/2 for |x| < 1/2; beyond, the difference loses < 3 bits.
  T series = T(1);
  for (int k = 16; k >= 3; --k) series = T(1) + T(1) / T(k) * x * series;
  return select(abs(x) < T(0.5), x * x / T(2) * series, expm1(x) - x);
}

}  // namespace pliant
