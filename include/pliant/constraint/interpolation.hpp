#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <pliant/constraint/slave.hpp>

namespace pliant {

/// The map P from free nodes to all nodes: a free node has its own value, a slave the weighted sum of its
/// masters'. Compressed rows of the slaves alone, so that a mesh without them costs nothing. On the host,
/// in any numbering; InterpolationOn has the same in a backend's memory.
class Interpolation {
 public:
  Interpolation() = default;
  /// Masters must be free nodes (see compose), and slaves ascend.
  explicit Interpolation(std::vector<Slave> slaves) : slaves_(std::move(slaves)) {}

  std::vector<Slave> const& slaves() const { return slaves_; }
  bool empty() const { return slaves_.empty(); }
  /// The row of a slave; null for a free node.
  Slave const* row_of(Index node) const {
    auto const found = std::lower_bound(slaves_.begin(), slaves_.end(), node,
                                        [](Slave const& s, Index n) { return s.node < n; });
    return found != slaves_.end() && found->node == node ? &*found : nullptr;
  }
  /// Calls visit(free node, weight) for each entry of a node's row.
  template <class Visit>
  void for_each_master(Index node, Visit const& visit) const {
    if (empty()) return visit(node, 1.0);
    Slave const* const slave = row_of(node);
    if (slave == nullptr) return visit(node, 1.0);
    for (auto const& [master, weight] : slave->masters) visit(master, weight);
  }

  /// Sets slaves to their interpolated values: value(node, k) is a reference, k < components.
  template <class Value>
  void apply(Value const& value, int components) const {
    for (auto const& [node, masters] : slaves_)
      for (int k = 0; k < components; ++k) {
        double const base = value(masters[0].first, k);  // what masters share is not rounded
        double sum = base;
        for (auto const& [master, weight] : masters) sum += weight * (value(master, k) - base);
        value(node, k) = sum;
      }
  }
  /// Hands what slaves hold to their masters, with the same weights, and sets slaves to zero.
  template <class Value>
  void apply_transpose(Value const& value, int components) const {
    for (auto const& [node, masters] : slaves_)
      for (int k = 0; k < components; ++k) {
        double const own = value(node, k);
        for (auto const& [master, weight] : masters) value(master, k) += weight * own;
        value(node, k) = 0;
      }
  }

  /// What the mass of a slave is to its masters. Forces go by the weights w; masses by |w|/Σ|w|, which are the
  /// weights themselves where none is negative (those of quadratic elements can be), so that no mass becomes
  /// negative and the total stays.
  static double mass_weight(Slave const& slave, std::size_t k) {
    return std::abs(slave.masters[k].second) / magnitude(slave);
  }
  /// Σ|w| of a slave's weights, 1 where none is negative.
  static double magnitude(Slave const& slave) {
    double sum = 0, least = 0;
    for (auto const& [master, weight] : slave.masters) {
      sum += std::abs(weight);
      least = std::min(least, weight);
    }
    return least < 0 ? sum : 1;
  }
  /// The largest of all slaves, 1 or more.
  double magnitude() const {
    double largest = 1;
    for (Slave const& slave : slaves_) largest = std::max(largest, magnitude(slave));
    return largest;
  }
  /// Hands what slaves hold to their masters by the weights of masses, and sets slaves to zero.
  template <class Value>
  void hand_masses(Value const& value, int components) const {
    for (Slave const& slave : slaves_)
      for (int k = 0; k < components; ++k) {
        double const own = value(slave.node, k);
        for (std::size_t m = 0; m < slave.masters.size(); ++m)
          value(slave.masters[m].first, k) += mass_weight(slave, m) * own;
        value(slave.node, k) = 0;
      }
  }
  /// Sets slaves to the mean of their masters by the weights of masses: to the velocity at which their mass moves.
  template <class Value>
  void apply_masses(Value const& value, int components) const {
    for (Slave const& slave : slaves_)
      for (int k = 0; k < components; ++k) {
        double const base = value(slave.masters[0].first, k);
        double sum = base;
        for (std::size_t m = 0; m < slave.masters.size(); ++m)
          sum += mass_weight(slave, m) * (value(slave.masters[m].first, k) - base);
        value(slave.node, k) = sum;
      }
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("slaves", r.slaves_...);
  }

 private:
  std::vector<Slave> slaves_;
};

}  // namespace pliant
