#pragma once

#include <cstddef>
#include <vector>

#include <pliant/config.hpp>

namespace pliant::detail {

/// The positions of a list's entries, grouped by a key: those of key k are order[first[k]] to
/// order[first[k + 1] − 1], ascending.
struct GroupedByKey {
  std::vector<Index> first, order;
};

/// Keys lie in [0, count); one pass counts, another fills.
inline GroupedByKey group_by_key(std::vector<Index> const& keys, Index count) {
  GroupedByKey grouped;
  grouped.first.resize(static_cast<std::size_t>(count) + 1);
  grouped.order.resize(keys.size());
  for (Index key : keys) ++grouped.first[static_cast<std::size_t>(key) + 1];
  for (std::size_t k = 1; k < grouped.first.size(); ++k) grouped.first[k] += grouped.first[k - 1];
  auto next = grouped.first;
  for (std::size_t i = 0; i < keys.size(); ++i)
    grouped.order[static_cast<std::size_t>(next[static_cast<std::size_t>(keys[i])]++)] =
        static_cast<Index>(i);
  return grouped;
}

}  // namespace pliant::detail
