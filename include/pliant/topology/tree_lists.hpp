#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/topology/shared_list.hpp>
#include <pliant/topology/tree_cell.hpp>

namespace pliant {

/// What a CellTree holds, and how many cells use each edge and side. Copies share what neither changes.
struct TreeLists {
  SharedList<TreeCell> cells;
  SharedList<TreeEdge> edges;
  SharedList<TreeSide> sides;
  std::vector<Index> divided;  ///< cells, each once
  std::vector<Index>
      converted;  ///< cells of the initial mesh that have not what they had there: each once
  Index linear_leaves = 0, quadratic_leaves = 0;  ///< with corners only, and others
  TreeSizes initial;                              ///< of the initial mesh
  Index nodes = 0;

  [[nodiscard]] bool is_leaf(Index c) const { return cells[at(c)].first_child < 0; }

  /// The edges of cells, each once, ascending.
  [[nodiscard]] std::vector<Index> edges_of(std::vector<Index> const& chosen) const {
    std::vector<Index> list;
    for (Index const c : chosen)
      std::copy_n(cells[at(c)].edges.begin(), cells[at(c)].pattern().edges,
                  std::back_inserter(list));
    return detail::each_once(std::move(list), edges.size());
  }
  /// The sides of solid cells, each once, ascending.
  [[nodiscard]] std::vector<Index> sides_of(std::vector<Index> const& chosen) const {
    std::vector<Index> list;
    for (Index const c : chosen)
      std::copy_n(cells[at(c)].sides.begin(), cells[at(c)].pattern().sides,
                  std::back_inserter(list));
    return detail::each_once(std::move(list), sides.size());
  }

  /// The nodes of the element on a cell, in the order of an element's whose corners are cell.nodes.
  [[nodiscard]] CellNodeList nodes_of(Index c) const {
    auto const& cell = cells[at(c)];
    auto const& p = cell.pattern();
    CellNodeList list;
    for (std::size_t a = 0; a < at(p.corners); ++a) list.push_back(cell.nodes[a]);
    if (cell.has == CellNodes::corners) return list;
    for (std::size_t e = 0; e < at(p.edges); ++e) list.push_back(edges[at(cell.edges[e])].middle);
    if (cell.has != CellNodes::all) return list;
    for (std::size_t s = 0; s < at(p.sides); ++s)
      if (p.side_centre[s] >= 0) list.push_back(sides[at(cell.sides[s])].centre);
    if (p.centre >= 0) list.push_back(cell.centre);
    return list;
  }

  /// Which cells, edges and sides are to be edited, for `own`: several threads may add to it at once.
  class Touched {
   public:
    explicit Touched(TreeLists const& lists)
        : lists_(lists), cells_(lists.cells), edges_(lists.edges), sides_(lists.sides) {}
    /// A cell with its edges and sides, and the parts that these have: children of the cell use them.
    void add(Index c) {
      cells_.add(at(c));
      auto const& cell = lists_.cells[at(c)];
      auto const& p = cell.pattern();
      for (std::size_t e = 0; e < at(p.edges); ++e) {
        edges_.add(at(cell.edges[e]));
        add_some(edges_, lists_.edges[at(cell.edges[e])].first_half, 2);
      }
      for (std::size_t s = 0; s < at(p.sides); ++s) {
        auto const& side = lists_.sides[at(cell.sides[s])];
        bool const is_halved =
            side.first_child >= 0 && lists_.sides[at(side.first_child)].level == side.level;
        sides_.add(at(cell.sides[s]));
        add_some(sides_, side.first_child, is_halved ? 2 : 4);
        add_some(edges_, side.first_inner_edge, is_halved ? 1 : side.corners());
      }
    }

   private:
    friend TreeLists;
    /// So many from `first` on; none where that is −1.
    template <class Entries>
    static void add_some(Entries& entries, Index first, std::size_t count) {
      for (std::size_t k = 0; first >= 0 && k < count; ++k) entries.add(at(first) + k);
    }
    TreeLists const& lists_;
    SharedList<TreeCell>::Touched cells_;
    SharedList<TreeEdge>::Touched edges_;
    SharedList<TreeSide>::Touched sides_;
  };
  /// Makes these the tree's own, whoever shared them: then several threads may edit them at once.
  void own(Touched const& touched) {
    cells.own(touched.cells_);
    edges.own(touched.edges_);
    sides.own(touched.sides_);
  }

  /// Counts a leaf at its edges, or with `by` = −1 no more. `cell`: as it is while it is a leaf.
  void count_leaf(TreeCell const& cell, int by) {
    for_each_edge(cell, [&](TreeEdge& edge, auto const& add) {
      add(edge.leaves, by);
      if (cell.has == CellNodes::corners) add(edge.linear, by);
    });
  }
  /// The same for a refined cell. Split ones count by their children.
  void count_refined(TreeCell const& cell, int by) {
    for_each_edge(cell, [&](TreeEdge& edge, auto const& add) { add(edge.refined, by); });
  }
  /// Counts so many leaves with these nodes in all.
  void count_leaves(CellNodes has, Index by) {
    (has == CellNodes::corners ? linear_leaves : quadratic_leaves) += by;
  }

  /// Side s of a cell, as the cell sees it.
  static TreeSide side_of(TreeCell const& cell, std::size_t s) {
    auto const& p = cell.pattern();
    TreeSide side{.level = cell.level};
    for (std::size_t k = 0; k < at(p.corners_of_side(static_cast<int>(s))); ++k) {
      side.nodes[k] = cell.nodes[at(p.side[s][k])];
      side.edges[k] = cell.edges[at(p.edges_of_side[s][k])];
    }
    return side;
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("cells", r.cells...);
    visit("edges", r.edges...);
    visit("sides", r.sides...);
    visit("divided cells", r.divided...);
    visit("cells of other degrees", r.converted...);
    visit("leaves with corners only", r.linear_leaves...);
    visit("other leaves", r.quadratic_leaves...);
    visit("initial mesh", r.initial...);
    visit("number of nodes", r.nodes...);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  /// visit(edge, add): add(number, by) for a number of the edge, which several threads may count at once.
  template <class Visit>
  void for_each_edge(TreeCell const& cell, Visit const& visit) {
    bool const shared = HostThreads::in_loop();
    auto const add = [shared](int& number, int by) {
      if (shared)
        std::atomic_ref(number).fetch_add(by, std::memory_order_relaxed);
      else
        number += by;
    };
    for (std::size_t e = 0; e < at(cell.pattern().edges); ++e)
      visit(edges.edit(at(cell.edges[e])), add);
  }
};

}  // namespace pliant
