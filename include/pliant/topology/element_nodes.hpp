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

/// The nodes between its corners that the element on a cell makes: by a bit each, and the first of them.
struct CellNodesMade {
  std::uint32_t bits = 0;
  Index first = 0;
};

/// The nodes that elements on cells of a tree have between their corners, as loops over the cells see them: one call of each
/// function for each cell, which is told by its place in the list. All claim those that are missing, then all count them;
/// with numbers they are made: on edges, on sides with four corners and in the middle.
struct ElementNodesView {
  TreeView tree;
  Index const* cells;
  CellNodesMade* own;
  bool on_parents;             // whether nodes are placed on the cells' parents, or on themselves
  Index first_node = 0;        // that is new
  PlacedNode* made = nullptr;  // by nodes, from that on

  PLIANT_HOST_DEVICE void claim_nodes(Index k) const {
    visit(k, [&](int, Index& node, auto const&...) { claim(node, k, tree.shared); });
  }
  PLIANT_HOST_DEVICE void find_nodes(Index k) const {
    std::uint32_t bits = 0;
    visit(k,
          [&](int i, Index& node, auto const&...) { bits |= std::uint32_t{makes(k, node)} << i; });
    own[k].bits = bits;
  }
  PLIANT_HOST_DEVICE void make_nodes(Index k) const {
    Index const c = cells[k], parent = tree.cells[at(c)].parent;
    std::uint32_t const bits = own[k].bits;
    Index next = own[k].first;
    visit(k, [&](int i, Index& node, auto const& corners, int count) {
      if ((bits >> i & 1) == 0) return;
      node = next++;
      PlacedNode placed{.node = node, .cell = on_parents ? parent : c};
      if (on_parents) placed.had = tree.cells[at(parent)].has;
      for (int corner = 0; corner < count; ++corner)
        for (std::size_t d = 0; d < 3; ++d)
          placed.place[d] += place_of_corner(c, corners[at(corner)])[d] / count;
      made[node - first_node] = placed;
    });
  }

 private:
  static PLIANT_HOST_DEVICE std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  /// Where a corner of a cell lies on its parent, or on itself.
  [[nodiscard]] PLIANT_HOST_DEVICE std::array<double, 3> const& place_of_corner(Index c,
                                                                                int corner) const {
    auto const& cell = tree.cells[at(c)];
    if (!on_parents) return cell.pattern().place[at(corner)];
    auto const& parent = tree.cells[at(cell.parent)];
    auto const& p = parent.divided();
    return p.place[at(p.child[at(c - parent.first_child)][at(corner)])];
  }
  /// visit(i, node, corners, count) for the i-th of the nodes that the k-th cell has between its corners, and those around it:
  /// −1, or a claim, where it is missing.
  template <class Visit>
  PLIANT_HOST_DEVICE void visit(Index k, Visit const& visit_node) const {
    auto& cell = tree.cells[at(cells[k])];
    auto const& p = cell.pattern();
    auto const row = tree.row(cells[k]);
    if (cell.has == CellNodes::corners) return;
    int i = 0;
    for (std::size_t e = 0; e < at(p.edges); ++e)
      visit_node(i++, tree.edges[at(row.edges[e])].middle, p.edge[e], 2);
    if (cell.has != CellNodes::all) return;
    for (std::size_t s = 0; s < at(p.sides); ++s)
      if (p.side_centre[s] >= 0) visit_node(i++, tree.sides[at(row.sides[s])].centre, p.side[s], 4);
    std::array<int, RefinementPattern::most_corners> all{0, 1, 2, 3, 4, 5, 6, 7};
    if (p.centre >= 0) visit_node(i, cell.centre, all, p.corners);
  }
};

/// Makes the nodes that elements on cells of a tree have between their corners, where they are missing, on the threads of
/// the host, and appends them to `made`. `on_parents`: see ElementNodesView.
inline void make_element_nodes(TreeLists& lists, std::vector<Index> const& cells, bool on_parents,
                               std::vector<PlacedNode>& made) {
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  auto const count = static_cast<Index>(cells.size());
  auto const for_each = [&](auto const& f) { for_each_on_host(count, 512, f); };
  if (cells.empty()) return;
  TreeLists::Touched touched(lists);
  for_each([&](Index k) { touched.add(cells[at(k)]); });
  lists.own(touched);
  std::vector<CellNodesMade> own(cells.size());
  ElementNodesView view{lists.view(), cells.data(), own.data(), on_parents, lists.nodes};
  for_each([&](Index k) { view.claim_nodes(k); });
  for_each([&](Index k) { view.find_nodes(k); });
  for (auto& [bits, first] : own) {
    first = lists.nodes;
    lists.nodes += std::popcount(bits);
  }
  auto const known = made.size();
  made.resize(known + at(lists.nodes - view.first_node));
  view.made = made.data() + known;
  for_each([&](Index k) { view.make_nodes(k); });
}

}  // namespace pliant::detail
