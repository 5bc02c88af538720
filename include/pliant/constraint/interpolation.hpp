#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <pliant/constraint/slave_rows.hpp>
#include <pliant/math/uncontracted.hpp>

namespace pliant {

/// The map P from free nodes to all nodes: a free node has its own value, a slave the weighted sum of its
/// masters'. Compressed rows of the slaves alone, so that a mesh without them costs nothing. On the host,
/// in any numbering; InterpolationOn has the same in a backend's memory.
class Interpolation {
 public:
  Interpolation() = default;
  /// Masters must be free nodes (see compose), and slaves ascend.
  explicit Interpolation(std::vector<Slave> const& slaves) : slaves_(detail::rows_of(slaves)) {}
  template <std::same_as<SlaveRows> Rows>  // no braces: those are a list of slaves
  explicit Interpolation(Rows slaves) : slaves_(std::move(slaves)) {}

  SlaveRows const& slaves() const { return slaves_; }
  bool empty() const { return slaves_.empty(); }
  /// The row of a slave, which the interpolation must outlive; none for a free node.
  std::optional<SlaveRow> row_of(Index node) const {
    auto const nodes = slaves_.nodes();
    auto const found = std::ranges::lower_bound(nodes, node);
    if (found == nodes.end() || *found != node) return std::nullopt;
    return slaves_[static_cast<std::size_t>(found - nodes.begin())];
  }
  /// Calls visit(free node, weight) for each entry of a node's row.
  template <class Visit>
  void for_each_master(Index node, Visit const& visit) const {
    if (empty()) return visit(node, 1.0);
    auto const slave = row_of(node);
    if (!slave) return visit(node, 1.0);
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
  static double mass_weight(SlaveRow const& slave, std::size_t k) {
    return std::abs(slave.masters[k].second) / magnitude(slave);
  }
  /// Σ|w| of a slave's weights, 1 where none is negative.
  static double magnitude(SlaveRow const& slave) {
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
    for (SlaveRow const& slave : slaves_) largest = std::max(largest, magnitude(slave));
    return largest;
  }
  /// Hands what slaves hold to their masters by the weights of masses, and sets slaves to zero. What comes out has the same bits on
  /// a device: see MassWeightsOn.
  template <class Value>
  void hand_masses(Value const& value, int components) const {
    for (SlaveRow const& slave : slaves_)
      for (int k = 0; k < components; ++k) {
        double const own = value(slave.node, k);
        for (std::size_t m = 0; m < slave.masters.size(); ++m) {
          double& of_master = value(slave.masters[m].first, k);
          of_master = (S(of_master) + S(mass_weight(slave, m)) * S(own)).value;
        }
        value(slave.node, k) = 0;
      }
  }
  /// Sets slaves to the mean of their masters by the weights of masses: to the velocity at which their mass moves.
  template <class Value>
  void apply_masses(Value const& value, int components) const {
    for (SlaveRow const& slave : slaves_)
      for (int k = 0; k < components; ++k) {
        S const base = value(slave.masters[0].first, k);
        S sum = base;
        for (std::size_t m = 0; m < slave.masters.size(); ++m)
          sum += S(mass_weight(slave, m)) * (S(value(slave.masters[m].first, k)) - base);
        value(slave.node, k) = sum.value;
      }
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("slaves", r.slaves_...);
  }

 private:
  using S = Uncontracted;

  SlaveRows slaves_;
};

}  // namespace pliant
