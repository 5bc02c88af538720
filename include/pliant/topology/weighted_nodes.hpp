#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/place_iterator.hpp>

namespace pliant {

/// A node and the weight that it has in a sum.
using NodeWeight = std::pair<Index, double>;

/// A node that comes or goes with a change of topology: its value is a weighted sum over nodes that stay. A view of one in
/// a list, which it must not outlive.
struct NewNode {
  Index node = -1;
  std::span<NodeWeight const> parents;  ///< weights add up to one
};

/// Nodes as weighted sums over others, in compressed rows: parents of all stand in one list.
class WeightedNodes {
 public:
  /// One that has its own list of parents, to write nodes down.
  struct Single {
    Index node = -1;
    std::vector<NodeWeight> parents;
  };

  WeightedNodes() = default;
  WeightedNodes(std::initializer_list<Single> nodes) {
    for (auto const& [node, parents] : nodes) push_back(node, parents);
  }
  /// Room for nodes with so many parents each, which `set` fills.
  explicit WeightedNodes(std::vector<std::size_t> const& parents) : nodes_(parents.size(), -1) {
    ends_.reserve(parents.size());
    std::size_t end = 0;
    for (std::size_t const count : parents) ends_.push_back(end += count);
    parents_.resize(end);
  }
  /// Those that add(k, list) appends for each k < count, in this order, on the threads of the host: `few` are worth one.
  template <class Add>
  static WeightedNodes made_on_host(Index count, Index few, Add const& add) {
    detail::HostParts const parts(count, few);
    std::vector<WeightedNodes> lists(static_cast<std::size_t>(parts.count()));
    parts([&](Index from, Index to, int part) {
      auto const size = static_cast<std::size_t>(to - from);
      WeightedNodes own;
      own.reserve(size, 2 * size);  // most lie in the middle of an edge
      for (Index k = from; k < to; ++k) add(k, own);
      lists[static_cast<std::size_t>(part)] = std::move(own);
    });
    auto all = std::move(lists.front());
    std::size_t nodes = all.nodes_.size(), parents = all.parents_.size();
    for (auto const& list : std::span(lists).subspan(1)) {
      nodes += list.nodes_.size();
      parents += list.parents_.size();
    }
    all.reserve(nodes, parents);
    for (auto const& list : std::span(lists).subspan(1)) all.append(list);
    return all;
  }

  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] bool empty() const { return nodes_.empty(); }
  NewNode operator[](std::size_t i) const {
    return {nodes_[i], {parents_.data() + first(i), parents_.data() + ends_[i]}};
  }
  [[nodiscard]] NewNode back() const { return (*this)[size() - 1]; }
  [[nodiscard]] auto begin() const { return PlaceIterator(*this, 0); }
  [[nodiscard]] auto end() const { return PlaceIterator(*this, size()); }

  void reserve(std::size_t nodes, std::size_t parents) {
    nodes_.reserve(nodes);
    ends_.reserve(nodes);
    parents_.reserve(parents);
  }
  /// Parents that are none of this list's.
  void push_back(Index node, std::span<NodeWeight const> parents) {
    nodes_.push_back(node);
    parents_.insert(parents_.end(), parents.begin(), parents.end());
    ends_.push_back(parents_.size());
  }
  void push_back(NewNode const& node) { push_back(node.node, node.parents); }
  /// The nodes of another list behind those of this one.
  void append(WeightedNodes const& other) {
    std::size_t const before = parents_.size();
    nodes_.insert(nodes_.end(), other.nodes_.begin(), other.nodes_.end());
    parents_.insert(parents_.end(), other.parents_.begin(), other.parents_.end());
    for (std::size_t const end : other.ends_) ends_.push_back(before + end);
  }
  /// Puts a node in a place that has room for as many parents. Several threads may fill places of their own.
  void set(std::size_t i, NewNode const& node) {
    nodes_[i] = node.node;
    std::ranges::copy(node.parents, parents_.begin() + static_cast<std::ptrdiff_t>(first(i)));
  }

 private:
  [[nodiscard]] std::size_t first(std::size_t i) const { return i == 0 ? 0 : ends_[i - 1]; }

  std::vector<Index> nodes_;
  std::vector<std::size_t> ends_;  // of parents, by the place of the node
  std::vector<NodeWeight> parents_;
};

}  // namespace pliant
