#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <pliant/config.hpp>

namespace pliant {

/// The edges of a plane mesh under refinement, and the halves into which they are cut: the
/// bookkeeping of Hierarchy. Edges are numbered as they come and stay for good.
class EdgeTree {
 public:
  struct Edge {
    std::array<Index, 2> nodes{-1, -1};  ///< in the direction of cells[0]
    std::array<Index, 2> cells{-1, -1};  ///< those of which it is a whole side
    Index parent = -1;                   ///< the edge of which it is a half
    Index middle = -1;                   ///< the node that halves it; -1 while it is whole
    Index first_half = -1;               ///< from nodes[0] to middle; the other half follows

    template <class Visit, class... R>
    static void for_each_member(Visit const& visit, R&... r) {
      visit("nodes", r.nodes...);
      visit("cells", r.cells...);
      visit("parent", r.parent...);
      visit("middle", r.middle...);
      visit("first half", r.first_half...);
    }
  };

  [[nodiscard]] Edge const& operator[](Index e) const { return edges_[at(e)]; }
  [[nodiscard]] std::size_t size() const { return edges_.size(); }
  [[nodiscard]] auto begin() const { return edges_.begin(); }
  [[nodiscard]] auto end() const { return edges_.end(); }

  /// The initial edge between two nodes, in either direction, or -1.
  [[nodiscard]] Index find(std::array<Index, 2> const& nodes) const {
    auto const found = initial_.find(key(nodes));
    return found == initial_.end() ? -1 : found->second;
  }

  /// Adds an edge that `find` can find.
  Index add_initial(std::array<Index, 2> const& nodes) {
    auto const e = add(nodes);
    initial_.emplace(key(nodes), e);
    return e;
  }

  Index add(std::array<Index, 2> const& nodes, Index parent = -1) {
    edges_.push_back({.nodes = nodes, .parent = parent});
    return static_cast<Index>(edges_.size()) - 1;
  }

  /// Tells an edge that it is a whole side of the cell; there may be two such cells.
  void attach(Index e, Index cell) {
    auto& cells = edges_[at(e)].cells;
    cells[cells[0] < 0 ? 0 : 1] = cell;
  }

  void bisect(Index e, Index middle) {
    auto const [from, to] = edges_[at(e)].nodes;
    auto const first = add({from, middle}, e);
    add({middle, to}, e);
    edges_[at(e)].middle = middle;
    edges_[at(e)].first_half = first;
  }

  /// The half of a bisected edge that touches its end `node`.
  [[nodiscard]] Index half_at(Index e, Index node) const {
    auto const& edge = edges_[at(e)];
    return edge.nodes[0] == node ? edge.first_half : edge.first_half + 1;
  }

  /// The coarser cell across the side e of a cell with this parent, or -1 where there is none.
  [[nodiscard]] Index coarser_across(Index e, Index parent_cell) const {
    auto const& edge = edges_[at(e)];
    if (edge.cells[1] >= 0 || edge.parent < 0) return -1;
    auto const& cells = edges_[at(edge.parent)].cells;
    return cells[0] == parent_cell ? cells[1] : cells[0];
  }

  /// Makes room for further edges, in amortized constant time for each.
  void make_room(std::size_t more) {
    auto const needed = edges_.size() + more;
    if (needed > edges_.capacity()) edges_.reserve(std::max(needed, 2 * edges_.size()));
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("edges", r.edges_...);
    visit("initial edges", r.initial_...);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static std::uint64_t key(std::array<Index, 2> const& nodes) {
    auto const [low, high] = std::minmax(nodes[0], nodes[1]);
    return std::uint64_t{static_cast<std::uint32_t>(low)} << 32U | static_cast<std::uint32_t>(high);
  }

  std::vector<Edge> edges_;
  std::unordered_map<std::uint64_t, Index> initial_;  // only looked up: its order does not matter
};

}  // namespace pliant
