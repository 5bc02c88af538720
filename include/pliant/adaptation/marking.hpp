#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <type_traits>

#include <pliant/backend/backend.hpp>
#include <pliant/error.hpp>
#include <pliant/math/functions.hpp>

namespace pliant {

enum class MarkingKind {
  above,                ///< value > amount
  below,                ///< value < amount
  fraction_of_largest,  ///< value > amount · largest value
  top_share,            ///< the elements of largest value, `amount` of all that are looked at
  bulk  ///< the fewest elements whose values add up to `amount` of the total (Dörfler)
};

/// Which of the elements that a criterion looks at act.
struct Marking {
  MarkingKind kind = MarkingKind::above;
  double amount = 0;
  double floor = -std::numeric_limits<double>::infinity();  // no element below acts
  long budget = std::numeric_limits<long>::max();           // elements per check, at the most

  /// Whether values must be compared with each other before any element may act.
  bool ranks() const {
    return (kind != MarkingKind::above && kind != MarkingKind::below) ||
           budget != std::numeric_limits<long>::max();
  }
  bool below() const { return kind == MarkingKind::below; }
};

namespace detail {

/// Counts, or adds up, the values beyond a threshold. Elements that nobody looks at hold NaN.
template <class T, bool Below, bool Sum>
struct BeyondThreshold {
  T const* values;
  T threshold;
  PLIANT_HOST_DEVICE double operator()(Index e) const {
    bool const beyond = Below ? values[e] < threshold : values[e] > threshold;
    return beyond ? (Sum ? static_cast<double>(values[e]) : 1.0) : 0.0;
  }
};
/// What is infinite counts as the largest number.
template <class T>
struct SignedValue {
  T const* values;
  T sign;
  PLIANT_HOST_DEVICE double operator()(Index e) const {
    constexpr T most = std::numeric_limits<T>::max();
    T const v = sign * values[e];
    return v == v ? static_cast<double>(max(-most, min(v, most)))
                  : -std::numeric_limits<double>::infinity();
  }
};

/// The threshold nearest to `loose` for which fits(threshold) holds, knowing that it holds at
/// `strict` and that it is monotonous; to the last bit of T, in at most as many halvings as T has bits:
/// of the interval of the numbers' bit patterns, which has no more of them near zero.
template <class T, class Fits>
T bisect(T loose, T strict, Fits const& fits) {
  using Pattern = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
  // In the order of the numbers; its own inverse.
  auto const ordered = [](Pattern p) {
    return p < 0 ? p ^ std::numeric_limits<Pattern>::max() : p;
  };
  if (fits(loose)) return loose;
  Pattern not_yet = ordered(std::bit_cast<Pattern>(loose));
  Pattern fitting = ordered(std::bit_cast<Pattern>(strict));
  for (;;) {
    Pattern const middle = std::midpoint(not_yet, fitting);
    if (middle == not_yet || middle == fitting) return std::bit_cast<T>(ordered(fitting));
    (fits(std::bit_cast<T>(ordered(middle))) ? fitting : not_yet) = middle;
  }
}

}  // namespace detail

/// The threshold beyond which elements act (above it, or below for MarkingKind::below), given the
/// criterion's value for each element in the backend's memory, NaN where it was not asked. Only
/// counts and sums come to the host. With a budget and equal values at the limit, fewer act.
template <Backend B>
typename B::scalar threshold_of(Marking const& m, B const& backend,
                                typename B::scalar const* values, Index count) {
  using T = typename B::scalar;
  T const sign = m.below() ? T(-1) : T(1);
  auto const extreme = backend.maximum(count, detail::SignedValue<T>{values, sign});
  T const strict = sign * std::numeric_limits<T>::infinity();  // beyond it there is nobody
  if (!std::isfinite(extreme)) return strict;                  // nobody asked
  T const loose = static_cast<T>(
      sign *
      std::nextafter(static_cast<T>(-backend.maximum(count, detail::SignedValue<T>{values, -sign})),
                     -std::numeric_limits<T>::infinity()));  // beyond it there is everybody
  auto const beyond = [&]<bool Sum>(T threshold, std::bool_constant<Sum>) {
    return m.below()
               ? backend.sum(count, detail::BeyondThreshold<T, true, Sum>{values, threshold})
               : backend.sum(count, detail::BeyondThreshold<T, false, Sum>{values, threshold});
  };
  auto const number = [&](T threshold) { return beyond(threshold, std::false_type{}); };

  T threshold = static_cast<T>(m.amount);
  switch (m.kind) {
    case MarkingKind::above:
    case MarkingKind::below:
      break;
    case MarkingKind::fraction_of_largest:
      threshold = static_cast<T>(m.amount * extreme);
      break;
    case MarkingKind::top_share: {
      double const most = m.amount * number(loose);
      threshold = detail::bisect(loose, strict, [&](T t) { return number(t) <= most; });
      break;
    }
    case MarkingKind::bulk: {
      double const wanted = m.amount > 0 ? m.amount * beyond(loose, std::true_type{}) : 0;
      threshold =
          detail::bisect(strict, loose, [&](T t) { return beyond(t, std::true_type{}) >= wanted; });
      break;
    }
  }
  threshold = m.below() ? threshold : std::max(threshold, static_cast<T>(m.floor));
  if (m.budget != std::numeric_limits<long>::max()) {
    auto const most = static_cast<double>(m.budget);
    bool const tighter = m.below() ? strict < threshold : strict > threshold;
    if (tighter)
      threshold = detail::bisect(threshold, strict, [&](T t) { return number(t) <= most; });
  }
  return threshold;
}

}  // namespace pliant
