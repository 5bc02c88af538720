#pragma once

#include <array>
#include <concepts>

#include <pliant/adaptation/criterion/criterion.hpp>

namespace pliant::detail {

/// A criterion that gives a Vector of so many values.
template <class C>
concept GivesSeveral = requires {
  { C::values } -> std::convertible_to<int>;
};
template <class C>
inline constexpr int values_of = 1;
template <GivesSeveral C>
inline constexpr int values_of<C> = C::values;

/// The first row of the values of each rule's criterion. Rules on different groups share rows, as do rules on
/// one group whose criteria are the same.
template <class Table, class... Rules>
struct CriterionRows {
  static constexpr std::size_t count = sizeof...(Rules);

  template <class A, class B>
  static constexpr bool same_value = std::same_as<typename A::from, typename B::from> &&
                                     std::same_as<decltype(A::criterion), decltype(B::criterion)> &&
                                     stateless<decltype(A::criterion)>;
  template <class A>
  static constexpr std::array<bool, count> same_values{same_value<A, Rules>...};

  std::array<int, count> row{};
  std::array<bool, count> first{};  // of the rules with the same value

  static constexpr CriterionRows make() {
    CriterionRows r;
    std::array<int, count> const group{Table::template group_of<typename Rules::from>...},
        values{values_of<decltype(Rules::criterion)>...};
    std::array<std::array<bool, count>, count> const same{same_values<Rules>...};
    for (std::size_t i = 0; i < count; ++i) {
      r.first[i] = true;
      for (std::size_t j = 0; j < i; ++j)
        if (r.first[i] && same[i][j]) {
          r.first[i] = false;
          r.row[i] = r.row[j];
        }
      if (r.first[i])
        for (std::size_t j = 0; j < i; ++j)
          r.row[i] += group[j] == group[i] && r.first[j] ? values[j] : 0;
    }
    return r;
  }
};

}  // namespace pliant::detail
