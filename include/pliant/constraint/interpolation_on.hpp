#pragma once

#include <algorithm>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/constraint/interpolation.hpp>
#include <pliant/math/group_by_key.hpp>

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
    auto const by_slave = rows_by_slave(host.slaves(), number);
    to_slaves_ = Rows(backend, by_slave);
    to_masters_ = Rows(backend, rows_by_master(by_slave));
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
  static HostRows rows_by_slave(std::vector<Slave> const& slaves, Number const& number) {
    HostRows rows;
    rows.first.reserve(slaves.size() + 1);
    for (Slave const& slave : slaves)
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
  static HostRows rows_by_master(HostRows const& by_slave) {
    std::vector<Index> slave(by_slave.other.size());
    for (std::size_t k = 0; k < by_slave.node.size(); ++k)
      std::fill(slave.begin() + by_slave.first[k], slave.begin() + by_slave.first[k + 1],
                by_slave.node[k]);
    auto const& master = by_slave.other;
    auto const last = std::ranges::max_element(master);
    auto const grouped = detail::group_by_key(master, last == master.end() ? 0 : *last + 1);
    HostRows rows;
    for (std::size_t k = 0; k + 1 < grouped.first.size(); ++k) {
      if (grouped.first[k] == grouped.first[k + 1]) continue;
      rows.node.push_back(static_cast<Index>(k));
      rows.first.push_back(grouped.first[k + 1]);
    }
    rows.other.resize(master.size());
    rows.weight.resize(master.size());
    detail::for_each_on_host(static_cast<Index>(master.size()), few, [&](Index k) {
      auto const entry = at(grouped.order[at(k)]);
      rows.other[at(k)] = slave[entry];
      rows.weight[at(k)] = by_slave.weight[entry];
    });
    return rows;
  }

  Rows to_slaves_, to_masters_;
  double magnitude_ = 1;
};

}  // namespace pliant
