#pragma once

#include <algorithm>
#include <vector>

#include <pliant/backend/backend.hpp>
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
      : to_slaves_(backend, rows_by_slave(host.slaves())),
        to_masters_(backend, rows_by_master(host.slaves())),
        magnitude_(host.magnitude()) {}

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

  static HostRows rows_by_slave(std::vector<Slave> const& slaves) {
    HostRows rows;
    for (auto const& [node, masters] : slaves) {
      rows.node.push_back(node);
      for (auto const& [master, weight] : masters) {
        rows.other.push_back(master);
        rows.weight.push_back(static_cast<T>(weight));
      }
      rows.first.push_back(static_cast<Index>(rows.other.size()));
    }
    return rows;
  }
  static HostRows rows_by_master(std::vector<Slave> const& slaves) {
    std::vector<Index> slave, master;
    std::vector<double> weight;
    for (auto const& [node, masters] : slaves)
      for (auto const& [other, share] : masters) {
        slave.push_back(node);
        master.push_back(other);
        weight.push_back(share);
      }
    HostRows rows;
    auto const last = std::ranges::max_element(master);
    auto const grouped = detail::group_by_key(master, last == master.end() ? 0 : *last + 1);
    for (std::size_t k = 0; k + 1 < grouped.first.size(); ++k) {
      if (grouped.first[k] == grouped.first[k + 1]) continue;
      rows.node.push_back(static_cast<Index>(k));
      for (Index j = grouped.first[k]; j < grouped.first[k + 1]; ++j) {
        auto const entry = static_cast<std::size_t>(grouped.order[static_cast<std::size_t>(j)]);
        rows.other.push_back(slave[entry]);
        rows.weight.push_back(static_cast<T>(weight[entry]));
      }
      rows.first.push_back(static_cast<Index>(rows.other.size()));
    }
    return rows;
  }

  Rows to_slaves_, to_masters_;
  double magnitude_ = 1;
};

}  // namespace pliant
