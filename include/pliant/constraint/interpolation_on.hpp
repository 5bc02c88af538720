#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/constraint/interpolation.hpp>

namespace pliant {

namespace detail {
/// What a row of an interpolation does to its node: sets it to the weighted sum over others, adds that to it, or adds the
/// sum with the weights' magnitudes.
enum class RowAction { set, add, add_magnitudes };
/// One row of an interpolation.
template <class T, int C, RowAction Action>
struct WeightedRow {
  static constexpr bool Add = Action != RowAction::set;
  NodeField<T, C> field;
  Index const *node, *first, *other;
  T const* weight;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    auto base = Vector<T, C>::zero();
    if constexpr (!Add) base = field.at(other[first[k]]);
    auto sum = Add ? field.at(node[k]) : base;
    for (Index j = first[k]; j < first[k + 1]; ++j)
      sum = sum + (Action == RowAction::add_magnitudes ? abs(weight[j]) : weight[j]) *
                      (field.at(other[j]) - base);
    field.set(node[k], sum);
  }
};
/// Raises a node to the largest value of others, where that is more.
template <class T>
struct LargestOfRow {
  NodeField<T, 1> field;
  Index const *node, *first, *other;
  PLIANT_HOST_DEVICE void operator()(Index k) const {
    T largest = field(node[k], 0);
    for (Index j = first[k]; j < first[k + 1]; ++j) largest = max(largest, field(other[j], 0));
    field(node[k], 0) = largest;
  }
};
template <class T, int C>
struct ClearRow {
  NodeField<T, C> field;
  Index const* node;
  PLIANT_HOST_DEVICE void operator()(Index k) const { field.set(node[k], Vector<T, C>::zero()); }
};

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
}  // namespace detail

/// An Interpolation in the memory of a backend: compressed rows in both directions, so that values go
/// from masters to slaves, and forces from slaves to masters, without two writers of a node.
template <Backend B>
class InterpolationOn {
  using T = typename B::scalar;

 public:
  InterpolationOn() = default;
  InterpolationOn(B const& backend, Interpolation const& host)
      : InterpolationOn(backend, host, [](Index node) { return node; }) {}
  /// The same where number(node) is the number of a node there.
  template <class Number>
  InterpolationOn(B const& backend, Interpolation const& host, Number const& number)
      : magnitude_(host.magnitude()) {
    if (host.empty()) return;
    to_slaves_ = Rows(backend, rows_by_slave(host.slaves(), number));
    to_masters_ = transposed(backend, to_slaves_);
  }

  bool empty() const { return to_slaves_.count == 0; }

  /// v ← P v: sets slaves from their masters, v_s = Σ_i P_si v_i, as v_1 + Σ_i P_si (v_i − v_1) since
  /// weights add up to one: what masters share is not rounded.
  template <int C>
  void apply(B const& backend, NodeField<T, C> field) const {
    if (!empty())
      backend.for_each(to_slaves_.count,
                       to_slaves_.template rows<C, detail::RowAction::set>(field));
  }
  /// Adds Pᵀ of what slaves hold to their masters, f_i += Σ_s P_si f_s; slaves keep theirs.
  template <int C>
  void add_transpose(B const& backend, NodeField<T, C> field) const {
    if (!empty())
      backend.for_each(to_masters_.count,
                       to_masters_.template rows<C, detail::RowAction::add>(field));
  }
  /// f ← Pᵀ f: the same, and slaves hold nothing afterwards.
  template <int C>
  void apply_transpose(B const& backend, NodeField<T, C> field) const {
    add_transpose(backend, field);
    clear(backend, field);
  }
  /// Adds magnitudes that slaves hold to their masters, f_i += Σ_s |P_si| f_s, and sets slaves to zero.
  template <int C>
  void hand_on_magnitudes(B const& backend, NodeField<T, C> field) const {
    if (!empty())
      backend.for_each(to_masters_.count,
                       to_masters_.template rows<C, detail::RowAction::add_magnitudes>(field));
    clear(backend, field);
  }
  /// The largest Σ_i |P_si|: 1 where no weight is negative.
  double magnitude() const { return magnitude_; }
  /// Raises masters to the largest value of their slaves, where that is more.
  void raise_masters(B const& backend, NodeField<T, 1> field) const {
    if (!empty()) backend.for_each(to_masters_.count, to_masters_.largest(field));
  }
  /// Raises slaves to the largest value of their masters, where that is more.
  void raise_slaves(B const& backend, NodeField<T, 1> field) const {
    if (!empty()) backend.for_each(to_slaves_.count, to_slaves_.largest(field));
  }
  /// Sets a field to zero at the slaves.
  template <int C>
  void clear(B const& backend, NodeField<T, C> field) const {
    if (!empty())
      backend.for_each(to_slaves_.count, detail::ClearRow<T, C>{field, to_slaves_.node.data()});
  }

 private:
  struct HostRows {
    std::vector<Index> node, first{0}, other;
    std::vector<T> weight;
  };
  struct Rows {
    Index count = 0;
    typename B::template Array<Index> node, first, other;
    typename B::template Array<T> weight;
    Rows() = default;
    Rows(B const& backend, HostRows const& rows)
        : count(static_cast<Index>(rows.node.size())),
          node(upload(backend, rows.node)),
          first(upload(backend, rows.first)),
          other(upload(backend, rows.other)),
          weight(upload(backend, rows.weight)) {}
    template <int C, detail::RowAction Action>
    detail::WeightedRow<T, C, Action> rows(NodeField<T, C> field) const {
      return {field, node.data(), first.data(), other.data(), weight.data()};
    }
    detail::LargestOfRow<T> largest(NodeField<T, 1> field) const {
      return {field, node.data(), first.data(), other.data()};
    }
  };

  static constexpr Index few = 8192;  // rows that are worth a thread

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  template <class Number>
  static HostRows rows_by_slave(SlaveRows const& slaves, Number const& number) {
    HostRows rows;
    rows.first.reserve(slaves.size() + 1);
    for (SlaveRow const& slave : slaves)
      rows.first.push_back(rows.first.back() + static_cast<Index>(slave.masters.size()));
    rows.node.resize(slaves.size());
    rows.other.resize(at(rows.first.back()));
    rows.weight.resize(at(rows.first.back()));
    detail::for_each_on_host(static_cast<Index>(slaves.size()), few, [&](Index k) {
      auto const& [node, masters] = slaves[at(k)];
      rows.node[at(k)] = number(node);
      auto entry = at(rows.first[at(k)]);
      for (auto const& [master, weight] : masters) {
        rows.other[entry] = number(master);
        rows.weight[entry++] = static_cast<T>(weight);
      }
    });
    return rows;
  }
  /// The same entries by the other node, ascending; those of one in the order in which they were.
  static Rows transposed(B const& backend, Rows const& rows) {
    auto const entries = rows.other.size();
    auto const n = static_cast<Index>(entries);
    auto keys = zeros<std::uint64_t>(backend, entries);
    auto order = zeros<Index>(backend, entries), row = zeros<Index>(backend, entries + 1);
    backend.for_each(n, detail::KeysOfEntries{rows.other.data(), keys.data(), order.data()});
    backend.sort(n, keys.data(), order.data(), std::numeric_limits<Index>::digits);
    backend.scan(n, detail::IsFirstOfKey{keys.data()}, row.data());
    Rows by_other;
    by_other.node = zeros<Index>(backend, entries);
    by_other.first = zeros<Index>(backend, entries + 1);
    by_other.other = zeros<Index>(backend, entries);
    by_other.weight = zeros<T>(backend, entries);
    backend.for_each(n, detail::TransposeRows<T>{
                            n, keys.data(), order.data(), row.data(), rows.count, rows.node.data(),
                            rows.first.data(), rows.weight.data(), by_other.node.data(),
                            by_other.first.data(), by_other.other.data(), by_other.weight.data()});
    auto count = zeros<Index>(backend, 1);
    backend.for_each(1, detail::CopyValue<Index>{row.data() + entries, count.data()});
    by_other.count = download<Index>(count)[0];
    return by_other;
  }

  Rows to_slaves_, to_masters_;
  double magnitude_ = 1;
};

}  // namespace pliant
