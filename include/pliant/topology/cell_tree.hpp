#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <unordered_set>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/error.hpp>
#include <pliant/topology/edge_tree.hpp>

namespace pliant {

/// A triangle or quadrilateral of a Hierarchy, counter-clockwise. Its side i joins node i to node
/// i + 1. A refined cell has its four children at first_child, first_child + 1, ...
struct HierarchyCell {
  int sides = 0;  ///< 3 or 4
  std::array<Index, 4> nodes{-1, -1, -1, -1};
  Index parent = -1;
  Index first_child = -1;  ///< -1 for a leaf
  int level = 0;           ///< 0 for the cells of the initial mesh

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("sides", r.sides...);
    visit("nodes", r.nodes...);
    visit("parent", r.parent...);
    visit("first child", r.first_child...);
    visit("level", r.level...);
  }
};

/// A node made by refinement: the mean of its first `count` parents, 2 for the midpoint of an edge
/// and 4 for the centre of a quadrilateral.
struct NewNode {
  Index node = -1;
  std::array<Index, 4> parents{-1, -1, -1, -1};
  int count = 0;
};

/// The cells and edges of a plane mesh under refinement, without geometry: the topology of
/// Hierarchy, whose docstring says how children are numbered.
class CellTree {
 public:
  CellTree() = default;
  /// Takes the nodes' number and cells whose node numbers are in range. Throws Error where more
  /// than one cell lies on one side of an edge.
  CellTree(std::vector<HierarchyCell> cells, Index nodes)
      : cells_(std::move(cells)), sides_(cells_.size()), nodes_(nodes) {
    for (Index c = 0; c < static_cast<Index>(cells_.size()); ++c) join_sides(c);
  }

  [[nodiscard]] std::vector<HierarchyCell> const& cells() const { return cells_; }
  [[nodiscard]] HierarchyCell const& operator[](Index c) const { return cells_[at(c)]; }
  [[nodiscard]] bool is_leaf(Index c) const { return cells_[at(c)].first_child < 0; }
  [[nodiscard]] EdgeTree const& edges() const { return edges_; }

  /// The edges of a cell; a triangle has no fourth one.
  [[nodiscard]] std::array<Index, 4> const& sides(Index c) const { return sides_[at(c)]; }

  /// The leaves, given each once, and all that must be refined before them so that levels differ by
  /// one at most across an edge: coarser ones first, then ascending.
  [[nodiscard]] std::vector<Index> closure(std::vector<Index> leaves) const {
    std::unordered_set<Index> seen(leaves.begin(), leaves.end());
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      auto const& cell = cells_[at(leaves[i])];
      for (std::size_t s = 0; s < at(cell.sides); ++s) {
        auto const coarser = edges_.coarser_across(sides_[at(leaves[i])][s], cell.parent);
        if (coarser >= 0 && seen.insert(coarser).second) leaves.push_back(coarser);
      }
    }
    std::ranges::sort(leaves, {}, [&](Index c) { return std::pair(cells_[at(c)].level, c); });
    return leaves;
  }

  /// How many nodes it takes to split all of these leaves.
  [[nodiscard]] std::size_t count_new_nodes(std::vector<Index> const& leaves) const {
    std::size_t nodes = 0;
    std::unordered_set<Index> bisected;
    for (Index const c : leaves) {
      nodes += cells_[at(c)].sides == 4 ? 1 : 0;
      for (std::size_t s = 0; s < at(cells_[at(c)].sides); ++s) {
        auto const e = sides_[at(c)][s];
        nodes += edges_[e].middle < 0 && bisected.insert(e).second ? 1 : 0;
      }
    }
    return nodes;
  }

  /// Makes room to split so many leaves without allocation, in amortized constant time for each.
  void make_room(std::size_t leaves) {
    auto const needed = cells_.size() + 4 * leaves;
    if (needed > cells_.capacity()) cells_.reserve(std::max(needed, 2 * cells_.size()));
    if (needed > sides_.capacity()) sides_.reserve(std::max(needed, 2 * sides_.size()));
    edges_.make_room(most_new_edges * leaves);
  }
  static constexpr std::size_t most_new_edges = 12;  ///< of a leaf: eight halves, four inside

  /// Splits a leaf that has no coarser neighbour in four, and appends the nodes that it makes: the
  /// middles of sides in their order, then the centre of a quadrilateral.
  void split(Index c, std::vector<NewNode>& new_nodes) {
    auto const parent = cells_[at(c)];
    auto const sides = sides_[at(c)];
    auto const k = at(parent.sides);
    bool const quad = k == 4;
    auto const first = cells_[at(c)].first_child = static_cast<Index>(cells_.size());
    std::array<Index, 4> middle{}, inner{};
    for (std::size_t i = 0; i < k; ++i) {
      if (edges_[sides[i]].middle < 0) {
        auto const [a, b] = edges_[sides[i]].nodes;
        edges_.bisect(sides[i], nodes_);
        new_nodes.push_back({.node = nodes_++, .parents = {a, b, -1, -1}, .count = 2});
      }
      middle[i] = edges_[sides[i]].middle;
    }
    Index const centre = quad ? nodes_++ : -1;
    if (quad) new_nodes.push_back({.node = centre, .parents = parent.nodes, .count = 4});
    // Inner edge i joins the middle of side i to the centre, or round corner i of a triangle.
    for (std::size_t i = 0; i < k; ++i)
      inner[i] = edges_.add({middle[i], quad ? centre : middle[(i + k - 1) % k]});

    HierarchyCell const blank{.sides = parent.sides, .parent = c, .level = parent.level + 1};
    cells_.resize(cells_.size() + 4, blank);
    sides_.resize(cells_.size());
    for (std::size_t i = 0; i < k; ++i) {
      auto const next = (i + 1) % k, last = (i + k - 1) % k;
      auto const child = first + static_cast<Index>(i);
      auto& nodes = cells_[at(child)].nodes;
      nodes[i] = parent.nodes[i];
      nodes[next] = middle[i];
      nodes[last] = middle[last];
      set_side(child, i, edges_.half_at(sides[i], nodes[i]));
      set_side(child, next, inner[i]);
      set_side(child, last, edges_.half_at(sides[last], nodes[i]));
      if (quad) {
        nodes[(i + 2) % k] = centre;
        set_side(child, (i + 2) % k, inner[last]);
      } else {
        cells_[at(first + 3)].nodes[i] = middle[next];
        set_side(first + 3, i, inner[last]);
      }
    }
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("cells", r.cells_...);
    visit("sides of cells", r.sides_...);
    visit("edges", r.edges_...);
    visit("number of nodes", r.nodes_...);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  void join_sides(Index c) {
    auto const& nodes = cells_[at(c)].nodes;
    auto const k = at(cells_[at(c)].sides);
    for (std::size_t i = 0; i < k; ++i) {
      std::array const ends{nodes[i], nodes[(i + 1) % k]};
      auto e = edges_.find(ends);
      // Counter-clockwise neighbours run along their common edge in opposite directions.
      if (e >= 0 && (edges_[e].cells[1] >= 0 || edges_[e].nodes[0] == ends[0]))
        throw Error("Hierarchy: cell ", c, " overlaps another one at the edge from node ", ends[0],
                    " to ", ends[1], "; give each edge one cell on either side at most");
      if (e < 0) e = edges_.add_initial(ends);
      set_side(c, i, e);
    }
  }

  void set_side(Index c, std::size_t i, Index e) {
    sides_[at(c)][i] = e;
    edges_.attach(e, c);
  }

  std::vector<HierarchyCell> cells_;
  std::vector<std::array<Index, 4>> sides_;
  EdgeTree edges_;
  Index nodes_ = 0;
};

}  // namespace pliant
