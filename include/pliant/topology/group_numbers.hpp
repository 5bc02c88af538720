#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/math/first_of_each.hpp>
#include <pliant/math/group_by_key.hpp>
#include <pliant/math/unset_vector.hpp>

namespace pliant::detail {

/// Numbers from 0 on for groups of nodes, in the order in which they first come.
struct GroupNumbers {
  UnsetVector<Index> number;  ///< by group
  UnsetVector<Index> first;   ///< by number: the first of these groups
};

/// Of groups with the same last node. Without a call of memcmp, which == of arrays makes.
template <std::size_t N>
bool are_same(std::array<Index, N> const& a, std::array<Index, N> const& b) {
  for (std::size_t k = 0; k + 1 < N; ++k)
    if (a[k] != b[k]) return false;
  return true;
}

/// firsts[i]: the first group that is the same as groups[i], among those at some ascending positions, all with the same last node.
template <std::size_t N>
void find_firsts(std::span<std::array<Index, N> const> groups, std::span<Index const> positions,
                 std::span<Index> firsts) {
  auto const group = [&](Index i) -> auto& { return groups[static_cast<std::size_t>(i)]; };
  auto const first = [&](Index i) -> auto& { return firsts[static_cast<std::size_t>(i)]; };
  constexpr std::size_t few = 64;
  if (positions.size() <= few) {
    std::array<Index, few> known;
    std::size_t count = 0;
    for (Index const i : positions) {
      auto const end = known.begin() + static_cast<std::ptrdiff_t>(count);
      auto const same =
          std::find_if(known.begin(), end, [&](Index k) { return are_same(group(k), group(i)); });
      if (same == end) known[count++] = i;
      first(i) = same == end ? i : *same;
    }
    return;
  }
  std::vector<Index> order(positions.begin(), positions.end());
  std::ranges::sort(order, [&](Index a, Index b) {
    return are_same(group(a), group(b)) ? a < b : group(a) < group(b);
  });
  for (std::size_t k = 0; k < order.size(); ++k)
    first(order[k]) =
        k > 0 && are_same(group(order[k]), group(order[k - 1])) ? first(order[k - 1]) : order[k];
}

inline constexpr Index few_groups = 16384;  // worth a thread

/// From the first groups that are the same as others, by the group, to numbers.
inline void number_firsts(GroupNumbers& numbers) {
  auto const number = [&](Index i) -> Index& {
    return numbers.number[static_cast<std::size_t>(i)];
  };
  auto const n = static_cast<Index>(numbers.number.size());
  auto const rank = first_of_each(n, [&](Index i) { return number(i) == i ? 1 : 0; });
  numbers.first.resize(static_cast<std::size_t>(rank.back()));
  for_each_on_host(n, few_groups, [&](Index i) {
    auto const own = rank[static_cast<std::size_t>(i)];
    if (number(i) == i) numbers.first[static_cast<std::size_t>(own)] = i;
    number(i) = rank[static_cast<std::size_t>(number(i))];
  });
}

/// Groups in another order of their nodes are others; the last node of each is in [0, nodes).
template <std::size_t N>
GroupNumbers number_groups(UnsetVector<std::array<Index, N>> const& groups, Index nodes) {
  auto const n = static_cast<Index>(groups.size());
  UnsetVector<Index> last(groups.size());
  for_each_on_host(n, few_groups, [&](Index i) {
    last[static_cast<std::size_t>(i)] = groups[static_cast<std::size_t>(i)].back();
  });
  auto const by_last = group_by_key(last, nodes);
  GroupNumbers numbers{std::move(last), {}};
  for_each_on_host(nodes, 1024, [&](Index node) {
    auto const from = static_cast<std::size_t>(by_last.first[static_cast<std::size_t>(node)]),
               to = static_cast<std::size_t>(by_last.first[static_cast<std::size_t>(node) + 1]);
    find_firsts<N>(groups, std::span(by_last.order).subspan(from, to - from), numbers.number);
  });
  number_firsts(numbers);
  return numbers;
}

}  // namespace pliant::detail
