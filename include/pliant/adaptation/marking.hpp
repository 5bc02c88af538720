#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <pliant/error.hpp>

namespace pliant {

enum class MarkingKind {
  above,                ///< value > amount
  below,                ///< value < amount
  fraction_of_largest,  ///< value > amount · largest value; an infinite one counts as the largest number
  top_share,            ///< the elements of largest value, `amount` of all that may act
  bulk  ///< the fewest elements whose values add up to `amount` of the total (Dörfler)
};

/// Which of the elements that a criterion looks at act. Those where it is NaN never act, and are not
/// counted, nor are those that may not act: whose stay or level forbids it, or that an earlier rule takes. (The
/// largest value of `fraction_of_largest` may be theirs.) Of equal values at the limit of a share or a budget, as many act as it allows, by
/// ascending element number; those at the limit of a bulk all act.
struct Marking {
  MarkingKind kind = MarkingKind::above;
  double amount = 0;
  double floor = -std::numeric_limits<double>::infinity();  // no element below acts
  std::int64_t budget =
      std::numeric_limits<std::int64_t>::max();  // elements per check, at the most

  /// Whether values must be compared with each other before any element may act.
  bool ranks() const {
    return (kind != MarkingKind::above && kind != MarkingKind::below) ||
           budget != std::numeric_limits<std::int64_t>::max();
  }
  /// What a value exceeds that acts, whatever the others are; of `below`, its negative does.
  template <class T>
  T beyond() const {
    switch (kind) {
      case MarkingKind::below:
        return static_cast<T>(-amount);
      case MarkingKind::above:
        return static_cast<T>(std::max(amount, floor));
      default:
        return static_cast<T>(floor);
    }
  }
  bool below() const { return kind == MarkingKind::below; }
};

}  // namespace pliant
