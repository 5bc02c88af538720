#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include <pliant/backend/atomic.hpp>
#include <pliant/config.hpp>

namespace pliant::detail {

/// How many bits of a number that is not zero come before its first one. (nvcc takes that of the standard library for 64 on a
/// device, without a word.)
PLIANT_HOST_DEVICE int leading_zeros(std::uint64_t x) {
#if defined(__CUDA_ARCH__)
  return __clzll(static_cast<long long>(x));
#else
  return std::countl_zero(x);
#endif
}

/// A sum of multiples of a unit, which has no rounding and does not depend on the order: a number of 128 bits in two's
/// complement.
struct ExactSum {
  std::uint64_t high = 0, low = 0;

  friend bool operator==(ExactSum const&, ExactSum const&) = default;
  PLIANT_HOST_DEVICE ExactSum operator-() const { return {~high + (low == 0), ~low + 1}; }
  PLIANT_HOST_DEVICE ExactSum& operator+=(ExactSum const& x) {
    low += x.low;
    high += x.high + (low < x.low);
    return *this;
  }
  /// The same where several threads add at once. What they give is there when all are done.
  PLIANT_HOST_DEVICE void add_from_threads(ExactSum const& x) {
    std::uint64_t const before = atomic_add(low, x.low);
    atomic_add(high, x.high + (before + x.low < before));
  }
  [[nodiscard]] PLIANT_HOST_DEVICE bool is_negative() const { return high >> 63 != 0; }
};

/// The unit of sums, a power of two: 2⁻¹²⁶ of one that no sum reaches. They are not negative where nothing else is said.
class SumUnit {
 public:
  SumUnit() : SumUnit(0) {}
  /// For sums less than `most`.
  explicit SumUnit(double most) {
    if (most > 0) exponent_ = std::isinf(most) ? 1024 : std::max(std::ilogb(most) + 1, exponent_);
    scale_ = std::ldexp(1.0, 62 - exponent_);
  }

  /// Whether a number may be a sum: one that is negative, too large or none may not.
  [[nodiscard]] PLIANT_HOST_DEVICE bool holds(double x) const {
    return x >= 0 && x * scale_ < 0x1p62;
  }
  /// A number that it holds, rounded down to a multiple; what is more than zero stays so.
  [[nodiscard]] PLIANT_HOST_DEVICE ExactSum multiple_of(double x) const {
    double const scaled = x * scale_;
    auto const high = static_cast<std::int64_t>(scaled);
    // Half of it fits a number with a sign: to others processors convert by a branch, which they guess wrong.
    auto const half_low = static_cast<std::int64_t>((scaled - static_cast<double>(high)) * 0x1p63);
    ExactSum const multiple{static_cast<std::uint64_t>(high), static_cast<std::uint64_t>(half_low)
                                                                  << 1};
    return x > 0 && multiple == ExactSum{} ? ExactSum{0, 1} : multiple;
  }
  /// The number nearest to a sum that is not negative.
  [[nodiscard]] PLIANT_HOST_DEVICE double value_of(ExactSum const& sum) const {
    int const unit = exponent_ - 126;
    if (sum.high == 0) return std::ldexp(static_cast<double>(sum.low), unit);
    int const shift = leading_zeros(sum.high);
    std::uint64_t leading = sum.high, rest = sum.low;
    if (shift > 0) {
      leading = sum.high << shift | sum.low >> (64 - shift);
      rest = sum.low << shift;
    }
    if (rest != 0) leading |= 1;  // it lies above the middle between two numbers
    return std::ldexp(static_cast<double>(leading), unit + 64 - shift);
  }
  /// The same of numbers, and sums, that may be negative.
  [[nodiscard]] PLIANT_HOST_DEVICE ExactSum signed_multiple_of(double x) const {
    return x < 0 ? -multiple_of(-x) : multiple_of(x);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE double signed_value_of(ExactSum const& sum) const {
    return sum.is_negative() ? -value_of(-sum) : value_of(sum);
  }

 private:
  int exponent_ = -900;  // of the power of two that no sum reaches; the inverse is finite
  double scale_;         // by which numbers become multiples of 2⁶⁴ units
};

}  // namespace pliant::detail
