#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/tree_claims.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// Where the corners of a cell lie on a cell that had its nodes before.
struct CellPlacement {
  Index cell = -1;
  CellNodes had = CellNodes::corners;
  std::array<std::array<double, 3>, RefinementPattern::most_corners> corners{};

  /// The middle of some of them.
  template <class Corners>
  [[nodiscard]] std::array<double, 3> mean(Corners const& chosen, std::size_t count) const {
    std::array<double, 3> sum{};
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t d = 0; d < 3; ++d)
        sum[d] += corners[static_cast<std::size_t>(chosen[k])][d] / static_cast<double>(count);
    return sum;
  }
};

/// Makes the nodes that elements on cells of a tree have between their corners, where they are missing, on the threads of
/// the host: cell after cell of the list on the edges, on sides with four corners and in the middle. Refers to the tree's
/// lists.
class ElementNodes {
 public:
  /// Appends them to `made`; placement(k): where the k-th cell's corners lie.
  template <class Placement>
  static void make(TreeLists& lists, std::vector<Index> const& cells, Placement const& placement,
                   std::vector<PlacedNode>& made) {
    if (!cells.empty()) ElementNodes(lists, cells).make(placement, made);
  }

 private:
  ElementNodes(TreeLists& lists, std::vector<Index> const& cells) : lists_(lists), cells_(cells) {
    TreeLists::Touched touched(lists);
    for_each([&](Index k) { touched.add(cells_[at(k)]); });
    lists.own(touched);
  }

  template <class Placement>
  void make(Placement const& placement, std::vector<PlacedNode>& made) {
    for_each([&](Index k) {
      visit(k, [&](std::size_t, Index& node, auto const&...) { claim(node, k); });
    });
    struct Own {
      std::uint32_t makes = 0;  // by a bit each, as they are visited
      Index first = 0;
    };
    std::vector<Own> own(cells_.size());
    for_each([&](Index k) {
      visit(k, [&](std::size_t i, Index& node, auto const&...) {
        own[at(k)].makes |= std::uint32_t{makes(k, node)} << i;
      });
    });
    Index const before = lists_.nodes;
    for (auto& [bits, first] : own) {
      first = lists_.nodes;
      lists_.nodes += std::popcount(bits);
    }
    auto const known = made.size();
    made.resize(known + at(lists_.nodes - before));
    for_each([&](Index k) {
      auto const place = placement(k);
      std::uint32_t const bits = own[at(k)].makes;
      Index next = own[at(k)].first;
      visit(k, [&](std::size_t i, Index& node, auto const& corners, std::size_t count) {
        if ((bits >> i & 1) == 0) return;
        node = next++;
        made[known + at(node - before)] = {node, place.cell, place.had, place.mean(corners, count)};
      });
    });
  }
  /// visit(i, node, corners, count) for the i-th of the nodes that the k-th cell has between its corners: −1, or a claim, where it
  /// is missing.
  template <class Visit>
  void visit(Index k, Visit const& visit) {
    auto const tree = lists_.view();
    auto& cell = tree.cells[at(cells_[at(k)])];
    auto const& p = cell.pattern();
    if (cell.has == CellNodes::corners) return;
    std::size_t i = 0;
    for (std::size_t e = 0; e < at(p.edges); ++e)
      visit(i++, tree.edges[at(cell.edges[e])].middle, p.edge[e], std::size_t{2});
    if (cell.has != CellNodes::all) return;
    for (std::size_t s = 0; s < at(p.sides); ++s)
      if (p.side_centre[s] >= 0)
        visit(i++, tree.sides[at(cell.sides[s])].centre, p.side[s], std::size_t{4});
    constexpr std::array<int, RefinementPattern::most_corners> all{0, 1, 2, 3, 4, 5, 6, 7};
    if (p.centre >= 0) visit(i, cell.centre, all, at(p.corners));
  }
  template <class F>
  void for_each(F const& f) const {
    for_each_on_host(static_cast<Index>(cells_.size()), 512, f);
  }
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  TreeLists& lists_;
  std::vector<Index> const& cells_;
};

}  // namespace pliant::detail
