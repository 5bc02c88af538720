#pragma once

#include <pliant/math/functions.hpp>

namespace pliant {

/// A double of which every operation rounds once: compilers fuse no product with a sum, as they else do by target, and
/// function by function. The same formula has the same bits then on all hosts and on devices.
struct Uncontracted {
  double value;

  Uncontracted() = default;
  template <Arithmetic A>
  PLIANT_HOST_DEVICE constexpr Uncontracted(A x) : value(static_cast<double>(x)) {}

  friend PLIANT_HOST_DEVICE Uncontracted operator+(Uncontracted a, Uncontracted b) {
#if defined(__CUDA_ARCH__)
    return __dadd_rn(a.value, b.value);
#else
    return a.value + b.value;
#endif
  }
  friend PLIANT_HOST_DEVICE Uncontracted operator-(Uncontracted a, Uncontracted b) {
#if defined(__CUDA_ARCH__)
    return __dsub_rn(a.value, b.value);
#else
    return a.value - b.value;
#endif
  }
  friend PLIANT_HOST_DEVICE Uncontracted operator*(Uncontracted a, Uncontracted b) {
#if defined(__CUDA_ARCH__)
    return __dmul_rn(a.value, b.value);
#else
    return kept(a.value * b.value);
#endif
  }
  friend PLIANT_HOST_DEVICE Uncontracted operator/(Uncontracted a, Uncontracted b) {
#if defined(__CUDA_ARCH__)
    return __ddiv_rn(a.value, b.value);
#else
    return a.value / b.value;
#endif
  }
  friend PLIANT_HOST_DEVICE Uncontracted operator-(Uncontracted a) { return -a.value; }
  friend PLIANT_HOST_DEVICE Uncontracted& operator+=(Uncontracted& a, Uncontracted b) {
    return a = a + b;
  }
  friend PLIANT_HOST_DEVICE Uncontracted& operator-=(Uncontracted& a, Uncontracted b) {
    return a = a - b;
  }
  friend PLIANT_HOST_DEVICE bool operator<(Uncontracted a, Uncontracted b) {
    return a.value < b.value;
  }
  friend PLIANT_HOST_DEVICE bool operator<=(Uncontracted a, Uncontracted b) {
    return a.value <= b.value;
  }
  friend PLIANT_HOST_DEVICE bool operator==(Uncontracted a, Uncontracted b) {
    return a.value == b.value;
  }

 private:
  /// A product that the compiler takes for any number. Only a target that can fuse it needs that.
  static inline PLIANT_INLINE double kept(double x) {
#if defined(__FP_FAST_FMA) || defined(__FMA__) || defined(__aarch64__)
#if defined(__x86_64__)
    asm("" : "+x"(x));
#elif defined(__aarch64__)
    asm("" : "+w"(x));
#else
    asm("" : "+m"(x));
#endif
#endif
    return x;
  }
};

template <>
struct BuiltinScalar<Uncontracted> {
  using type = double;
};

PLIANT_HOST_DEVICE Uncontracted select(bool condition, Uncontracted a, Uncontracted b) {
  return condition ? a : b;
}
PLIANT_HOST_DEVICE bool any_less(Uncontracted a, Uncontracted b) { return a.value < b.value; }
PLIANT_HOST_DEVICE Uncontracted abs(Uncontracted const& x) { return abs(x.value); }

}  // namespace pliant
