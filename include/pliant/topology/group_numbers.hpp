#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/math/group_by_key.hpp>

namespace pliant::detail {

/// Numbers from 0 on for groups of nodes, in the order in which they first come.
struct GroupNumbers {
  std::vector<Index> number;  ///< by group
  std::vector<Index> first;   ///< by number: the first of these groups
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
void find_firsts(std::vector<std::array<Index, N>> const& groups, std::span<Index const> positions,
                 std::vector<Index>& firsts) {
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

/// Groups in another order of their nodes are others; the last node of each is in [0, nodes).
template <std::size_t N>
GroupNumbers number_groups(std::vector<std::array<Index, N>> const& groups, Index nodes) {
  auto const n = static_cast<Index>(groups.size());
  std::vector<Index> last(groups.size());
  constexpr Index few = 16384;  // worth a thread
  for_each_on_host(n, few, [&](Index i) {
    last[static_cast<std::size_t>(i)] = groups[static_cast<std::size_t>(i)].back();
  });
  auto const by_last = group_by_key(last, nodes);
  GroupNumbers numbers{std::move(last), {}};
  for_each_on_host(nodes, 1024, [&](Index node) {
    auto const from = static_cast<std::size_t>(by_last.first[static_cast<std::size_t>(node)]),
               to = static_cast<std::size_t>(by_last.first[static_cast<std::size_t>(node) + 1]);
    find_firsts<N>(groups, std::span(by_last.order).subspan(from, to - from), numbers.number);
  });
  for (Index i = 0; i < n; ++i) {
    Index& own = numbers.number[static_cast<std::size_t>(i)];
    if (own == i) {
      own = static_cast<Index>(numbers.first.size());
      numbers.first.push_back(i);
    } else {
      own = numbers.number[static_cast<std::size_t>(own)];
    }
  }
  return numbers;
}

}  // namespace pliant::detail
