#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <unordered_set>
#include <utility>
#include <vector>

#include <pliant/math/each_once.hpp>
#include <pliant/topology/cell_tree.hpp>

namespace pliant {

/// What is asked of a tree before it changes. Refers to the tree.
template <int Dim>
class TreeQueries {
 public:
  explicit TreeQueries(CellTree<Dim> const& tree)
      : tree_(tree), cells_(tree.cells()), edges_(tree.edges()), sides_(tree.sides()) {}

  /// The leaves, given each once, and all that must be refined before them so that levels differ by
  /// one at most across edges and sides: coarser ones first, then ascending. Each part of a side has an edge that lies between
  /// parts, so that edges tell of coarser neighbours across sides too.
  [[nodiscard]] std::vector<Index> closure(std::vector<Index> leaves) {
    std::vector<bool> seen(cells_.size(), false);
    for (Index const c : leaves) seen[at(c)] = true;
    auto const want = [&](Index c) {
      if (c < 0 || !tree_.is_leaf(c) || seen[at(c)]) return;
      seen[at(c)] = true;
      leaves.push_back(c);
    };
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      auto const* const edges = tree_.row(leaves[i]).edges;
      for (std::size_t e = 0; e < at(cells_[at(leaves[i])].pattern().edges); ++e) {
        Index coarse = edges[e], whole = coarse;
        do {
          whole = coarse;
          coarse = edges_[at(coarse)].parent();
        } while (coarse >= 0 && edges_[at(coarse)].cells.leaves() == 0);
        if (coarse >= 0) {
          for (Index const neighbour : cells_at(coarse)) want(neighbour);
        } else if (Index const side = edges_[at(whole)].side(); side >= 0) {
          // a leaf on the other side of a divided side may have none of it for an edge
          for (Index const neighbour : sides_[at(side)].cells) want(neighbour);
        }
      }
    }
    std::ranges::sort(leaves, {}, [&](Index c) { return std::pair(cells_[at(c)].level, c); });
    return leaves;
  }

  /// The leaves that share an edge, whole or in part, with given ones, and these: each once, ascending.
  [[nodiscard]] std::vector<Index> with_neighbours(std::vector<Index> const& leaves) {
    std::vector<Index> found;
    auto const add_leaves_at = [&](Index e) {
      for (Index const c : cells_at(e))
        if (tree_.is_leaf(c)) found.push_back(c);
    };
    for (Index const e : tree_.edges_of(leaves)) {
      auto const& edge = edges_[at(e)];
      add_leaves_at(e);
      Index const parent = edge.parent();
      if (parent >= 0 && edges_[at(parent)].cells.leaves() > 0) add_leaves_at(parent);
      for (Index half = edge.first_half; half >= 0 && half < edge.first_half + 2; ++half)
        add_leaves_at(half);
    }
    return detail::each_once(std::move(found), cells_.size());
  }

  /// How many nodes it takes to refine all of these leaves.
  [[nodiscard]] std::size_t count_new_nodes(std::vector<Index> const& leaves) const {
    std::size_t nodes = 0;
    std::vector<Index> without_middle, without_centre;
    std::unordered_set<Index> bisected, divided;
    auto const needs_middle = [&](Index e) {
      if (edges_[at(e)].middle < 0) without_middle.push_back(e);
    };
    auto const needs_centre = [&](Index s) {
      if (sides_[at(s)].centre < 0 && sides_[at(s)].corners() == 4) without_centre.push_back(s);
    };
    for (Index const c : leaves) {
      auto const& cell = cells_[at(c)];
      auto const own = tree_.row(c);
      auto const& p = cell.pattern();
      bool const quadratic = cell.has != CellNodes::corners, all = cell.has == CellNodes::all;
      for (std::size_t e = 0; e < at(p.edges); ++e) {
        needs_middle(own.edges[e]);
        if (!quadratic || !bisected.insert(own.edges[e]).second) continue;
        Index const half = edges_[at(own.edges[e])].first_half;
        if (half < 0) nodes += 2;
        for (Index h = half; half >= 0 && h < half + 2; ++h) needs_middle(h);
      }
      for (std::size_t s = 0; s < at(p.sides); ++s) {
        needs_centre(own.sides[s]);
        if (!quadratic || !divided.insert(own.sides[s]).second) continue;
        auto const& side = sides_[at(own.sides[s])];
        auto const n = static_cast<Index>(side.corners());
        if (side.first_child < 0) nodes += side.corners() + (all && n == 4 ? 4 : 0);
        for (Index k = 0; side.first_child >= 0 && k < n; ++k) {
          needs_middle(side.first_inner_edge + k);
          if (all) needs_centre(side.first_child + k);
        }
      }
      nodes += p.centre >= 0 && cell.centre < 0 ? 1 : 0;
      nodes += quadratic ? at(p.inner_edges) : 0;
      if (all && p.centre >= 0) nodes += at(p.inner_sides + p.children);
    }
    return nodes + detail::each_once(std::move(without_middle), edges_.size()).size() +
           detail::each_once(std::move(without_centre), sides_.size()).size();
  }

  /// How many nodes it takes to give leaves other degrees.
  [[nodiscard]] std::size_t count_new_nodes(std::vector<CellConversion> const& raised) const {
    std::size_t nodes = 0;
    std::unordered_set<Index> edges, sides;
    for (auto const& [c, has] : raised) {
      auto const& cell = cells_[at(c)];
      auto const own = tree_.row(c);
      auto const& p = cell.pattern();
      for (std::size_t e = 0; e < at(p.edges); ++e)
        if (edges_[at(own.edges[e])].middle < 0) edges.insert(own.edges[e]);
      if (has != CellNodes::all) continue;
      for (std::size_t s = 0; s < at(p.sides); ++s)
        if (p.side_centre[s] >= 0 && sides_[at(own.sides[s])].centre < 0)
          sides.insert(own.sides[s]);
      nodes += p.centre >= 0 && cell.centre < 0 ? 1 : 0;
    }
    return nodes + edges.size() + sides.size();
  }

  /// The cell on the other side of a pyramid's base; −1 where there is none.
  [[nodiscard]] Index across_base(Index pyramid) const {
    return tree_.lists().view().across_base(pyramid);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  [[nodiscard]] std::vector<Index> cells_at(Index e) {
    if (!at_edges_) at_edges_ = tree_.cells_at_edges();
    return tree_.cells_at(*at_edges_, e);
  }

  CellTree<Dim> const& tree_;
  std::shared_ptr<CellsAtEdges const> at_edges_;  // once it is needed
  SharedList<TreeCell> const& cells_;
  SharedList<TreeEdge> const& edges_;
  SharedList<TreeSide> const& sides_;
};

}  // namespace pliant
