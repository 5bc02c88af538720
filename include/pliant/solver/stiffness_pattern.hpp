#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <pliant/constraint/interpolation.hpp>
#include <pliant/solver/linear/block_matrix.hpp>

namespace pliant::detail {

/// Collects which nodes pull at each other, those of slaves handed to their masters, and makes the blocks of a
/// stiffness of them.
class CoupledNodes {
 public:
  CoupledNodes(Interpolation const& interpolation, Index nodes)
      : interpolation_(interpolation), first_of_node_(static_cast<std::size_t>(nodes) + 1) {}

  /// All nodes of an element pull at each other.
  template <class Nodes>
  void add(Nodes const& nodes) {
    auto const from = std::ssize(members_);
    for (Index node : nodes)
      interpolation_.for_each_master(node, [&](Index master, double) {
        if (std::find(members_.begin() + from, members_.end(), master) == members_.end())
          members_.push_back(master);
      });
    first_.push_back(std::ssize(members_));
  }

  /// A node without neighbours has its own block.
  template <int N>
  BlockMatrix<N, N> blocks() {
    auto const nodes = static_cast<Index>(first_of_node_.size()) - 1;
    for (Index node : members_) ++first_of_node_[static_cast<std::size_t>(node) + 1];
    for (std::size_t i = 1; i < first_of_node_.size(); ++i)
      first_of_node_[i] += first_of_node_[i - 1];
    std::vector<std::size_t> element_of(members_.size());
    std::vector<std::int64_t> next(first_of_node_.begin(), first_of_node_.end() - 1);
    for (std::size_t e = 0; e + 1 < first_.size(); ++e)
      for (auto k = first_[e]; k < first_[e + 1]; ++k)
        element_of[static_cast<std::size_t>(
            next[static_cast<std::size_t>(members_[static_cast<std::size_t>(k)])]++)] = e;

    BlockMatrix<N, N> out;
    out.columns = nodes;
    out.first.reserve(static_cast<std::size_t>(nodes) + 1);
    std::vector<Index> seen(static_cast<std::size_t>(nodes), -1);
    for (Index node = 0; node < nodes; ++node) {
      auto const begin = std::ssize(out.column);
      auto const take = [&](Index other) {
        if (std::exchange(seen[static_cast<std::size_t>(other)], node) != node)
          out.column.push_back(other);
      };
      take(node);
      auto const at = static_cast<std::size_t>(node);
      for (auto k = first_of_node_[at]; k < first_of_node_[at + 1]; ++k) {
        auto const e = element_of[static_cast<std::size_t>(k)];
        for (auto m = first_[e]; m < first_[e + 1]; ++m)
          take(members_[static_cast<std::size_t>(m)]);
      }
      std::sort(out.column.begin() + begin, out.column.end());
      out.first.push_back(std::ssize(out.column));
    }
    return out;
  }

 private:
  Interpolation const& interpolation_;
  std::vector<Index> members_;          // element after element
  std::vector<std::int64_t> first_{0};  // of each element's members
  std::vector<std::int64_t> first_of_node_;
};

}  // namespace pliant::detail
