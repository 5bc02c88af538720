#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>

#include <pliant/adaptation/criterion/criterion.hpp>
#include <pliant/adaptation/rule.hpp>
#include <pliant/math/matrix.hpp>

namespace pliant::detail {

/// Squared displacement gradients H:H above and below which rules may act on elements of group G of a table: −1 where none
/// does.
template <class Table, int G, class T, int Dim, class... Rules>
std::array<T, 2> gradient_range(std::tuple<Rules...> const& rules) {
  constexpr double infinite = std::numeric_limits<double>::infinity(), rounding = 1e-3;
  double least = infinite, most = -infinite;
  auto const add = [&]<class R>(R const& rule) {
    if constexpr (Table::template group_of<typename R::from> == G) {
      auto const threshold = static_cast<double>(rule.marking.template beyond<T>());
      if (!rule.marking.below()) {
        least = std::min(least, rule.criterion.least_gradient(threshold, Dim));
        most = infinite;
      } else if constexpr (BoundedBelowCriterion<decltype(R::criterion)>) {
        least = -infinite;
        most = std::max(most, rule.criterion.most_gradient(-threshold, Dim));
      } else {
        least = -infinite;
        most = infinite;
      }
    }
  };
  std::apply([&](auto const&... rule) { (add(rule), ...); }, rules);
  return {least > 0 ? static_cast<T>(square((1 - rounding) * least)) : T(-1),
          most > 0 ? static_cast<T>(square((1 + rounding) * most)) : T(-1)};
}

}  // namespace pliant::detail
