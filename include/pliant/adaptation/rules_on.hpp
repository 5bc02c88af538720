#pragma once

#include <concepts>
#include <tuple>

#include <pliant/adaptation/rule.hpp>

// Which rules of a list look at an element type.
namespace pliant::detail {

template <class R, class Table>
concept On = std::same_as<typename R::from::element, typename Table::element>;

template <class Table, class R>
inline constexpr bool has_target = true;
template <class Table, SwitchingRule R>
inline constexpr bool has_target<Table, R> =
    Table::template group_of<typename R::to> < Table::groups;

/// The rules of a list that look at a table.
template <class Table, class... Rules>
auto rules_on(std::tuple<Rules...> const& rules) {
  auto const one = []<class R>(R const& rule) {
    if constexpr (On<R, Table>)
      return std::tuple<R>{rule};
    else
      return std::tuple<>{};
  };
  return std::apply([&](auto const&... rule) { return std::tuple_cat(one(rule)...); }, rules);
}

}  // namespace pliant::detail
