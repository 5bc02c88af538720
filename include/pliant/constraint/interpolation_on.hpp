#pragma once

#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/constraint/interpolation.hpp>
#include <pliant/constraint/rows_on.hpp>

namespace pliant {

namespace detail {
/// What a row of an interpolation does to its node: sets it to the weighted sum over others, adds that to it, or adds the
/// sum with the weights' magnitudes.
enum class RowAction { set, add, add_magnitudes };
/// What becomes of the node of a row.
template <class T, int C>
struct RowValue {
  Index node;
  Vector<T, C> value;
};
/// One row of an interpolation.
template <class T, int C, RowAction Action>
struct WeightedRow {
  static constexpr bool Add = Action != RowAction::set;
  NodeField<T, C> field;
  Index const *node, *first, *other;
  T const* weight;
  PLIANT_HOST_DEVICE void operator()(Index k) const { write(read(k)); }
  /// What becomes of the row's node.
  PLIANT_HOST_DEVICE RowValue<T, C> read(Index k) const {
    auto base = Vector<T, C>::zero();
    if constexpr (!Add) base = field.at(other[first[k]]);
    return {node[k], sum(k, Add ? field.at(node[k]) : base, base)};
  }
  PLIANT_HOST_DEVICE void write(RowValue<T, C> const& row) const { field.set(row.node, row.value); }
  /// A row's sum over the others' differences from a base, begun at `from`.
  PLIANT_HOST_DEVICE Vector<T, C> sum(Index k, Vector<T, C> from, Vector<T, C> const& base) const {
    for (Index j = first[k]; j < first[k + 1]; ++j)
      from = from + (Action == RowAction::add_magnitudes ? abs(weight[j]) : weight[j]) *
                        (field.at(other[j]) - base);
    return from;
  }
};
/// Two of them for the same row, of different fields. All is read before anything is written, so that a device waits for memory
/// once.
template <class First, class Second>
struct BothRows {
  First first;
  Second second;
  PLIANT_HOST_DEVICE void operator()(Index k) const { write(read(k)); }
  PLIANT_HOST_DEVICE auto read(Index k) const {
    struct Values {
      decltype(first.read(k)) of_first;
      decltype(second.read(k)) of_second;
    };
    return Values{first.read(k), second.read(k)};
  }
  PLIANT_HOST_DEVICE void write(auto const& values) const {
    first.write(values.of_first);
    second.write(values.of_second);
  }
};
template <class First, class Second>
BothRows(First, Second) -> BothRows<First, Second>;
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
  PLIANT_HOST_DEVICE void operator()(Index k) const { write(read(k)); }
  PLIANT_HOST_DEVICE Index read(Index k) const { return node[k]; }
  PLIANT_HOST_DEVICE void write(Index row) const { field.set(row, Vector<T, C>::zero()); }
};

/// What a node is to an interpolation, where it is not the number of its row among masters.
inline constexpr Index is_free = -1, is_slave = -2;
/// Tells nodes the number of their row among masters, or that they are slaves.
struct TellRow {
  Index const* node;
  bool slaves;
  Index* row;  // (nodes)
  PLIANT_HOST_DEVICE void operator()(Index k) const { row[node[k]] = slaves ? is_slave : k; }
};
}  // namespace detail

/// Forces at nodes, to which those of slaves are handed on where they are read: at() is what add_transpose would bring about. Slaves
/// keep theirs, whatever is set, since other masters may still read them.
template <class T, int C>
class HandedOnForces {
 public:
  HandedOnForces(Index const* row, detail::WeightedRow<T, C, detail::RowAction::add> const& masters)
      : row_(row), masters_(masters) {}

  PLIANT_HOST_DEVICE Vector<T, C> at(Index node) const {
    auto const own = masters_.field.at(node);
    Index const row = row_[node];
    return row < 0 ? own : masters_.sum(row, own, Vector<T, C>::zero());
  }
  PLIANT_HOST_DEVICE void set(Index node, Vector<T, C> const& force) const {
    if (row_[node] != detail::is_slave) masters_.field.set(node, force);
  }

 private:
  Index const* row_;  // (nodes): of masters, or what else nodes are
  detail::WeightedRow<T, C, detail::RowAction::add> masters_;
};

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
    to_slaves_ = rows_by_slave(backend, host.slaves(), number);
    to_masters_ = detail::transposed(backend, to_slaves_);
  }
  /// Of slaves in the backend's memory, each once, whose masters are free. `has_negative`: whether weights may be negative;
  /// `nodes`: a number that those of masters are below; `before`: steps of loops (in_turn), behind which they are filled.
  template <class... Steps>
  InterpolationOn(B const& backend, RowsOn<B> slaves, bool has_negative = true,
                  Index nodes = std::numeric_limits<Index>::max(), Steps const&... before)
      : to_slaves_(std::move(slaves)) {
    if (empty()) return;
    to_masters_ = detail::transposed(backend, to_slaves_, nodes, before...);
    if (has_negative)
      magnitude_ = backend.maximum(
          to_slaves_.count,
          detail::MagnitudeOfRow<T>{to_slaves_.first.data(), to_slaves_.weight.data()});
  }

  bool empty() const { return to_slaves_.count == 0; }
  /// Its slaves with their masters, and masters with their slaves.
  RowsOn<B> const& slaves() const { return to_slaves_; }
  RowsOn<B> const& masters() const { return to_masters_; }

  /// v ← P v: sets slaves from their masters, v_s = Σ_i P_si v_i, as v_1 + Σ_i P_si (v_i − v_1) since
  /// weights add up to one: what masters share is not rounded.
  template <int C>
  void apply(B const& backend, NodeField<T, C> field) const {
    if (!empty())
      backend.for_each(to_slaves_.count, weighted<C, detail::RowAction::set>(to_slaves_, field));
  }
  /// The same of two fields at once.
  template <int C>
  void apply(B const& backend, NodeField<T, C> field, NodeField<T, C> other) const {
    constexpr auto set = detail::RowAction::set;
    if (!empty())
      backend.for_each(to_slaves_.count, detail::BothRows{weighted<C, set>(to_slaves_, field),
                                                          weighted<C, set>(to_slaves_, other)});
  }
  /// Adds Pᵀ of what slaves hold to their masters, f_i += Σ_s P_si f_s; slaves keep theirs.
  template <int C>
  void add_transpose(B const& backend, NodeField<T, C> field) const {
    if (!empty())
      backend.for_each(to_masters_.count, weighted<C, detail::RowAction::add>(to_masters_, field));
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
                       weighted<C, detail::RowAction::add_magnitudes>(to_masters_, field));
    clear(backend, field);
  }
  /// Before handed_on, of fields of so many nodes.
  void list_by_node(B const& backend, Index nodes) {
    if (empty() || by_node_.size() == at(nodes)) return;
    by_node_ = unset<Index>(backend, at(nodes));
    Index* const row = by_node_.data();
    backend.for_each(nodes, detail::FillValue<Index>{row, detail::is_free});
    backend.for_each(to_masters_.count, detail::TellRow{to_masters_.node.data(), false, row});
    backend.for_each(to_slaves_.count, detail::TellRow{to_slaves_.node.data(), true, row});
  }
  /// Forces that are to be handed on where they are read.
  template <int C>
  HandedOnForces<T, C> handed_on(NodeField<T, C> forces) const {
    return {by_node_.data(), weighted<C, detail::RowAction::add>(to_masters_, forces)};
  }
  /// `apply` to two fields, and slaves hold nothing of a third one: of forces that were handed on.
  template <int C>
  void apply_and_clear(B const& backend, NodeField<T, C> field, NodeField<T, C> other,
                       NodeField<T, C> forces) const {
    constexpr auto set = detail::RowAction::set;
    if (!empty())
      backend.for_each(to_slaves_.count,
                       detail::BothRows{detail::BothRows{weighted<C, set>(to_slaves_, field),
                                                         weighted<C, set>(to_slaves_, other)},
                                        detail::ClearRow<T, C>{forces, to_slaves_.node.data()}});
  }
  /// The largest Σ_i |P_si|: 1 where no weight is negative.
  double magnitude() const { return magnitude_; }
  /// Raises masters to the largest value of their slaves, where that is more.
  void raise_masters(B const& backend, NodeField<T, 1> field) const {
    if (!empty()) backend.for_each(to_masters_.count, largest(to_masters_, field));
  }
  /// Raises slaves to the largest value of their masters, where that is more.
  void raise_slaves(B const& backend, NodeField<T, 1> field) const {
    if (!empty()) backend.for_each(to_slaves_.count, largest(to_slaves_, field));
  }
  /// Sets a field to zero at the slaves.
  template <int C>
  void clear(B const& backend, NodeField<T, C> field) const {
    if (!empty())
      backend.for_each(to_slaves_.count, detail::ClearRow<T, C>{field, to_slaves_.node.data()});
  }

 private:
  static constexpr Index few = 8192;  // rows that are worth a thread

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  template <class Number>
  static RowsOn<B> rows_by_slave(B const& backend, SlaveRows const& slaves, Number const& number) {
    std::vector<Index> node(slaves.size()), first{0}, other;
    std::vector<T> weight;
    first.reserve(slaves.size() + 1);
    for (SlaveRow const& slave : slaves)
      first.push_back(first.back() + static_cast<Index>(slave.masters.size()));
    other.resize(at(first.back()));
    weight.resize(at(first.back()));
    detail::for_each_on_host(static_cast<Index>(slaves.size()), few, [&](Index k) {
      auto const& slave = slaves[at(k)];
      node[at(k)] = number(slave.node);
      auto entry = at(first[at(k)]);
      for (auto const& master : slave.masters) {
        other[entry] = number(master.first);
        weight[entry++] = static_cast<T>(master.second);
      }
    });
    return {static_cast<Index>(slaves.size()), upload(backend, node), upload(backend, first),
            upload(backend, other), upload(backend, weight)};
  }
  template <int C, detail::RowAction Action>
  static detail::WeightedRow<T, C, Action> weighted(RowsOn<B> const& rows, NodeField<T, C> field) {
    return {field, rows.node.data(), rows.first.data(), rows.other.data(), rows.weight.data()};
  }
  static detail::LargestOfRow<T> largest(RowsOn<B> const& rows, NodeField<T, 1> field) {
    return {field, rows.node.data(), rows.first.data(), rows.other.data()};
  }

  RowsOn<B> to_slaves_, to_masters_;
  typename B::template Array<Index> by_node_;  // see HandedOnForces
  double magnitude_ = 1;
};

}  // namespace pliant
