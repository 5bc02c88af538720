#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/in_turn.hpp>

namespace pliant {

/// Nodes as weighted sums over others, as compressed rows in the memory of a backend: row k, of node[k], has the entries
/// first[k] to before first[k + 1] of `other` and `weight`. Nodes, and numbers of first entries, may have room behind their rows.
template <Backend B>
struct RowsOn {
  Index count = 0;
  typename B::template Array<Index> node, first, other;
  typename B::template Array<typename B::scalar> weight;
  Index others = -1;  // how many different nodes the entries are of, where that is known
};

namespace detail {

/// Keys by which the entries of rows are sorted for rows in the other direction.
struct KeysOfEntries {
  Index const* other;
  std::uint64_t* keys;
  Index* entries;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    keys[i] = static_cast<std::uint64_t>(other[i]);
    entries[i] = i;
  }
};
/// Whether a sorted entry is the first of its key.
struct IsFirstOfKey {
  std::uint64_t const* keys;
  PLIANT_HOST_DEVICE Index operator()(Index i) const {
    return i == 0 || keys[i] != keys[i - 1] ? 1 : 0;
  }
};
/// Fills rows with the n sorted entries of `count` rows in the other direction.
template <class T>
struct TransposeRows {
  Index n;
  std::uint64_t const* keys;
  Index const* entries;
  Index const* row;  // by the sorted entry: how many rows began before it
  Index count;
  Index const *node_before, *first_before;
  T const* weight_before;
  Index *node, *first, *other;
  T* weight;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (row[i + 1] != row[i]) {
      node[row[i]] = static_cast<Index>(keys[i]);
      first[row[i]] = i;
    }
    if (i == n - 1) first[row[n]] = n;
    Index low = 0, high = count;  // the entry's row is in [low, high), and none is empty
    while (high - low > 1) {
      Index const middle = low + (high - low) / 2;
      (first_before[middle] <= entries[i] ? low : high) = middle;
    }
    other[i] = node_before[low];
    weight[i] = weight_before[entries[i]];
  }
};

/// Σ|w| of a slave's weights, 1 where none is negative.
template <class T>
struct MagnitudeOfRow {
  Index const* first;
  T const* weight;
  PLIANT_HOST_DEVICE double operator()(Index k) const {
    double sum = 0;
    bool negative = false;
    for (Index j = first[k]; j < first[k + 1]; ++j) {
      double const w = static_cast<double>(weight[j]);
      negative = negative || w < 0;
      sum += w < 0 ? -w : w;
    }
    return negative ? sum : 1;
  }
};

/// The same entries by the other node, ascending, which are below `nodes`; those of one in the order in which they were. No row
/// may be empty. `before`: steps of loops, behind which they are filled.
template <Backend B, class... Steps>
RowsOn<B> transposed(B const& backend, RowsOn<B> const& rows,
                     Index nodes = std::numeric_limits<Index>::max(), Steps const&... before) {
  using T = typename B::scalar;
  auto const entries = rows.other.size();
  auto const n = static_cast<Index>(entries);
  auto keys = unset<std::uint64_t>(backend, entries);
  auto order = unset<Index>(backend, entries), row = unset<Index>(backend, entries + 1),
       count = unset<Index>(backend, 1);
  RowsOn<B> by_other{rows.others, unset<Index>(backend, entries),
                     unset<Index>(backend, entries + 1), unset<Index>(backend, entries),
                     unset<T>(backend, entries)};
  in_turn(backend, before...,
          LoopStep{n, KeysOfEntries{rows.other.data(), keys.data(), order.data()}},
          SortStep{n, keys.data(), order.data(), key_bits(nodes)},
          ScanStep{n, IsFirstOfKey{keys.data()}, row.data()},
          LoopStep{n, TransposeRows<T>{n, keys.data(), order.data(), row.data(), rows.count,
                                       rows.node.data(), rows.first.data(), rows.weight.data(),
                                       by_other.node.data(), by_other.first.data(),
                                       by_other.other.data(), by_other.weight.data()}},
          LoopStep{rows.others < 0 ? 1 : 0, CopyValue<Index>{row.data() + entries, count.data()}});
  if (rows.others < 0) by_other.count = download<Index>(count)[0];
  return by_other;
}

}  // namespace detail

}  // namespace pliant
