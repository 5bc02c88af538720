#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include <pliant/topology/hierarchy.hpp>

#include "support/random.hpp"

// States of refinement trees, to be compared, and random leaves of theirs.
namespace pliant::test {

/// Looks at nothing.
struct Ignore {
  void operator()(auto const&...) const {}
};

/// All numbers of lists of cells, edges, sides, nodes or points.
template <class... Lists>
std::vector<Index> listed(Lists const&... lists) {
  std::vector<Index> numbers;
  auto const visit = [&](auto const& self, auto const& value) -> void {
    using V = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_floating_point_v<V>)
      numbers.push_back(static_cast<Index>(1e6 * value));
    else if constexpr (std::is_enum_v<V> || std::is_arithmetic_v<V>)
      for (std::size_t byte = 0; byte < sizeof(V); byte += sizeof(Index))
        numbers.push_back(static_cast<Index>(static_cast<std::uint64_t>(value) >> 8 * byte));
    else if constexpr (requires { V::for_each_member(Ignore{}, value); })
      V::for_each_member([&](char const*, auto const& own) { self(self, own); }, value);
    else
      for (auto const& own : value) self(self, own);
  };
  (visit(visit, lists), ...);
  return numbers;
}

/// Some of the leaves for which wanted(cell).
template <class Wanted>
std::vector<Index> some_leaves(Hierarchy<3> const& tree, std::size_t one_in, Random& random,
                               Wanted const& wanted) {
  auto leaves = tree.leaves();
  std::erase_if(leaves,
                [&](Index c) { return !wanted(tree.cell(c)) || random.below(one_in) != 0; });
  return leaves;
}

/// Facets in an order that does not depend on the one in which they came, nor on the corners at which they begin.
template <int Dim>
std::vector<std::vector<Index>> in_any_order(std::vector<Facet<Dim>> const& facets) {
  std::vector<std::vector<Index>> lists;
  for (auto const& facet : facets) {
    auto& list = lists.emplace_back(facet.begin(), facet.end());
    if (Dim == 3) std::rotate(list.begin(), std::ranges::min_element(list), list.end());
  }
  std::ranges::sort(lists);
  return lists;
}

}  // namespace pliant::test
