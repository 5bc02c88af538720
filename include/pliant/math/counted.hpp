#pragma once

#include <cstdint>

#include <pliant/math/functions.hpp>

namespace pliant {

/// A number whose operations are counted, each with about the cycles that a processor takes between two of its kind in
/// vectors. For the host; one count per thread.
struct Counted {
  double value = 0;

  Counted() = default;
  template <Arithmetic A>
  PLIANT_HOST_DEVICE constexpr Counted(A x) : value(static_cast<double>(x)) {}

  /// What has been counted.
  static std::int64_t& count() {
    static thread_local std::int64_t operations = 0;
    return operations;
  }
  /// x, which took so many operations.
  PLIANT_HOST_DEVICE static Counted after([[maybe_unused]] int operations, double x) {
#if !defined(__CUDA_ARCH__)
    count() += operations;
#endif
    return Counted(x);
  }

  friend PLIANT_HOST_DEVICE Counted operator+(Counted a, Counted b) {
    return after(1, a.value + b.value);
  }
  friend PLIANT_HOST_DEVICE Counted operator-(Counted a, Counted b) {
    return after(1, a.value - b.value);
  }
  friend PLIANT_HOST_DEVICE Counted operator*(Counted a, Counted b) {
    return after(1, a.value * b.value);
  }
  friend PLIANT_HOST_DEVICE Counted operator/(Counted a, Counted b) {
    return after(20, a.value / b.value);
  }
  friend PLIANT_HOST_DEVICE Counted operator-(Counted a) { return after(1, -a.value); }
  friend PLIANT_HOST_DEVICE Counted& operator+=(Counted& a, Counted b) { return a = a + b; }
  friend PLIANT_HOST_DEVICE Counted& operator-=(Counted& a, Counted b) { return a = a - b; }
  friend PLIANT_HOST_DEVICE Counted& operator*=(Counted& a, Counted b) { return a = a * b; }
  friend PLIANT_HOST_DEVICE bool operator<(Counted a, Counted b) { return a.value < b.value; }
  friend PLIANT_HOST_DEVICE bool operator==(Counted a, Counted b) { return a.value == b.value; }
};

template <>
struct BuiltinScalar<Counted> {
  using type = double;
};

PLIANT_HOST_DEVICE Counted select(bool condition, Counted a, Counted b) {
  return Counted::after(1, condition ? a.value : b.value);
}
PLIANT_HOST_DEVICE bool any_less(Counted a, Counted b) { return a.value < b.value; }
PLIANT_HOST_DEVICE Counted abs(Counted const& x) { return Counted::after(1, abs(x.value)); }
PLIANT_HOST_DEVICE Counted sqrt(Counted const& x) { return Counted::after(28, sqrt(x.value)); }
PLIANT_HOST_DEVICE Counted exp(Counted const& x) { return Counted::after(50, exp(x.value)); }
PLIANT_HOST_DEVICE Counted expm1(Counted const& x) { return Counted::after(50, expm1(x.value)); }
PLIANT_HOST_DEVICE Counted log(Counted const& x) { return Counted::after(70, log(x.value)); }
PLIANT_HOST_DEVICE Counted log1p(Counted const& x) { return Counted::after(70, log1p(x.value)); }
PLIANT_HOST_DEVICE Counted cbrt(Counted const& x) { return Counted::after(80, cbrt(x.value)); }

}  // namespace pliant
