#pragma once

#include <bit>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/math/unset_vector.hpp>

namespace pliant::detail {

/// The positions of a list's entries, grouped by a key: those of key k are order[first[k]] to
/// order[first[k + 1] − 1], ascending.
struct GroupedByKey {
  UnsetVector<Index> first, order;
};

/// Distributes the entries 0 to n − 1 to places, ordered by their keys, those of one key in their order: where each key's
/// places begin. count(from, to, numbers) adds to numbers[key] for each entry of a range; put(from, to, places) has each
/// of them take the place places[key]++. Keys are few: each thread counts them on its own.
inline std::vector<Index> distribute(Index n, Index keys,
                                     FunctionRef<void(Index, Index, Index*)> count,
                                     FunctionRef<void(Index, Index, Index*)> put) {
  HostParts const parts(n);
  auto const width = static_cast<std::size_t>(keys);
  std::vector<Index> next(static_cast<std::size_t>(parts.count()) * width);  // (parts, keys)
  auto const row = [&](int part) { return next.data() + static_cast<std::size_t>(part) * width; };
  parts([&](Index from, Index to, int part) { count(from, to, row(part)); });
  std::vector<Index> first(width + 1, n);
  Index before = 0;
  for (std::size_t k = 0; k < width; ++k) {
    first[k] = before;
    for (int part = 0; part < parts.count(); ++part) before += std::exchange(row(part)[k], before);
  }
  parts([&](Index from, Index to, int part) { put(from, to, row(part)); });
  return first;
}

/// By how many bits to shift keys below `count` to have a thousand at most, for `distribute`.
inline int shift_to_few(Index count) {
  return std::max(0, static_cast<int>(std::bit_width(static_cast<unsigned>(count))) - 10);
}

/// On several threads: entries go to ranges of keys first, then each range is counted and filled by one thread.
inline GroupedByKey group_by_ranges(std::span<Index const> keys, Index count) {
  struct Entry {
    Index key, position;
  };
  int const shift = shift_to_few(count);
  Index const ranges = (count >> shift) + 1, n = static_cast<Index>(keys.size());
  auto const entries = std::make_unique_for_overwrite<Entry[]>(keys.size());
  auto const begin = distribute(
      n, ranges,
      [&](Index from, Index to, Index* numbers) {
        for (Index i = from; i < to; ++i) ++numbers[keys[static_cast<std::size_t>(i)] >> shift];
      },
      [&](Index from, Index to, Index* places) {
        for (Index i = from; i < to; ++i) {
          Index const key = keys[static_cast<std::size_t>(i)];
          entries[static_cast<std::size_t>(places[key >> shift]++)] = {key, i};
        }
      });
  GroupedByKey grouped;
  grouped.first.resize(static_cast<std::size_t>(count) + 1);
  grouped.order.resize(keys.size());
  for_each_on_host(ranges, 1, [&](Index range) {
    auto const r = static_cast<std::size_t>(range);
    std::vector<Index> next(std::size_t{1} << shift);
    Index const lowest = range << shift;
    auto const each_entry = [&](auto const& visit) {
      for (Index k = begin[r]; k < begin[r + 1]; ++k) {
        Entry const& entry = entries[static_cast<std::size_t>(k)];
        visit(next[static_cast<std::size_t>(entry.key - lowest)], entry);
      }
    };
    each_entry([](Index& number, Entry const&) { ++number; });
    Index before = begin[r];
    for (std::size_t k = 0; k < next.size() && lowest + static_cast<Index>(k) < count; ++k) {
      grouped.first[static_cast<std::size_t>(lowest) + k] = before;
      before += std::exchange(next[k], before);
    }
    each_entry([&](Index& place, Entry const& entry) {
      grouped.order[static_cast<std::size_t>(place++)] = entry.position;
    });
  });
  grouped.first.back() = n;
  return grouped;
}

/// Keys lie in [0, count); one pass counts, another fills.
inline GroupedByKey group_by_key(std::span<Index const> keys, Index count) {
  constexpr std::size_t few = 65536;
  if (keys.size() >= few && has_many_host_threads()) return group_by_ranges(keys, count);
  GroupedByKey grouped;
  grouped.first.assign(static_cast<std::size_t>(count) + 1, 0);
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
