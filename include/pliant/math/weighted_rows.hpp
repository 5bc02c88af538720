#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/math/place_iterator.hpp>

namespace pliant {

/// A node and the weight that it has in a sum.
using NodeWeight = std::pair<Index, double>;

/// Nodes as weighted sums over others, in compressed rows: the weights of all stand in one list. View: what it gives of
/// one, a node and the span of its weights.
template <class View>
class WeightedRows {
 public:
  /// One that has its own list of weights, to write nodes down.
  struct Single {
    Index node = -1;
    std::vector<NodeWeight> weights;

    template <class Visit, class... R>
    static void for_each_member(Visit const& visit, R&... r) {
      visit("node", r.node...);
      visit("weights", r.weights...);
    }
  };
  using value_type = Single;  ///< what can be appended

  WeightedRows() = default;
  WeightedRows(std::initializer_list<Single> nodes) {
    for (Single const& node : nodes) push_back(node);
  }
  /// Room for nodes with so many weights each, which `set` fills.
  explicit WeightedRows(std::vector<std::size_t> const& weights) : nodes_(weights.size(), -1) {
    ends_.reserve(weights.size());
    std::size_t end = 0;
    for (std::size_t const count : weights) ends_.push_back(end += count);
    weights_.resize(end);
  }
  /// Those that add(k, list) appends for each k < count, in this order, on the threads of the host: `few` are worth one.
  template <class Add>
  static WeightedRows made_on_host(Index count, Index few, Add const& add) {
    detail::HostParts const parts(count, few);
    std::vector<WeightedRows> lists(static_cast<std::size_t>(parts.count()));
    parts([&](Index from, Index to, int part) {
      auto const size = static_cast<std::size_t>(to - from);
      WeightedRows own;
      own.reserve(size, 2 * size);  // most lie in the middle of an edge
      for (Index k = from; k < to; ++k) add(k, own);
      lists[static_cast<std::size_t>(part)] = std::move(own);
    });
    auto all = std::move(lists.front());
    std::size_t nodes = all.nodes_.size(), weights = all.weights_.size();
    for (auto const& list : std::span(lists).subspan(1)) {
      nodes += list.nodes_.size();
      weights += list.weights_.size();
    }
    all.reserve(nodes, weights);
    for (auto const& list : std::span(lists).subspan(1)) all.append(list);
    return all;
  }

  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] bool empty() const { return nodes_.empty(); }
  View operator[](std::size_t i) const {
    return {nodes_[i], {weights_.data() + first(i), weights_.data() + ends_[i]}};
  }
  [[nodiscard]] View back() const { return (*this)[size() - 1]; }
  /// All of them, without their weights.
  [[nodiscard]] std::span<Index const> nodes() const { return nodes_; }
  [[nodiscard]] auto begin() const { return PlaceIterator(*this, 0); }
  [[nodiscard]] auto end() const { return PlaceIterator(*this, size()); }

  void reserve(std::size_t nodes, std::size_t weights) {
    nodes_.reserve(nodes);
    ends_.reserve(nodes);
    weights_.reserve(weights);
  }
  /// Weights that are none of this list's.
  void push_back(Index node, std::span<NodeWeight const> weights) {
    nodes_.push_back(node);
    weights_.insert(weights_.end(), weights.begin(), weights.end());
    ends_.push_back(weights_.size());
  }
  void push_back(View const& view) {
    auto const& [node, weights] = view;
    push_back(node, weights);
  }
  void push_back(Single const& single) { push_back(single.node, single.weights); }
  void clear() { *this = WeightedRows(); }
  /// The nodes of another list behind those of this one.
  void append(WeightedRows const& other) {
    std::size_t const before = weights_.size();
    nodes_.insert(nodes_.end(), other.nodes_.begin(), other.nodes_.end());
    weights_.insert(weights_.end(), other.weights_.begin(), other.weights_.end());
    for (std::size_t const end : other.ends_) ends_.push_back(before + end);
  }
  /// Puts a node in a place that has room for as many weights. Several threads may fill places of their own.
  void set(std::size_t i, View const& view) {
    auto const& [node, weights] = view;
    nodes_[i] = node;
    std::ranges::copy(weights, weights_.begin() + static_cast<std::ptrdiff_t>(first(i)));
  }

 private:
  [[nodiscard]] std::size_t first(std::size_t i) const { return i == 0 ? 0 : ends_[i - 1]; }

  std::vector<Index> nodes_;
  std::vector<std::size_t> ends_;  // of weights, by the place of the node
  std::vector<NodeWeight> weights_;
};

}  // namespace pliant
