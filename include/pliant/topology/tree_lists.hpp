#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/topology/division_marks.hpp>
#include <pliant/topology/shared_list.hpp>
#include <pliant/topology/tree_view.hpp>

namespace pliant {

/// What a CellTree holds, and how many cells use each edge and side. Copies share what neither changes.
struct TreeLists {
  SharedList<TreeCell> cells;
  SharedList<TreeEdge> edges;
  SharedList<TreeSide> sides;
  SharedList<RowEntry> rows;  ///< of cells
  RowLayout layout;
  std::vector<Index> divided{};  ///< cells, each once
  std::vector<Index>
      converted{};  ///< cells of the initial mesh that have not what they had there: each once
  Index linear_leaves = 0, quadratic_leaves = 0;  ///< with corners only, and others
  TreeSizes initial;                              ///< of the initial mesh
  Index nodes = 0;
  detail::DivisionMarks divisions{};  ///< for TreeCompaction, which leaves alone what came before

  [[nodiscard]] bool is_leaf(Index c) const { return cells[at(c)].first_child < 0; }

  /// The edges of cells, each once, ascending.
  [[nodiscard]] std::vector<Index> edges_of(std::vector<Index> const& chosen) const {
    std::vector<Index> list;
    for (Index const c : chosen)
      std::copy_n(row(c).edges, cells[at(c)].pattern().edges, std::back_inserter(list));
    return detail::each_once(std::move(list), edges.size());
  }
  /// The sides of solid cells, each once, ascending.
  [[nodiscard]] std::vector<Index> sides_of(std::vector<Index> const& chosen) const {
    std::vector<Index> list;
    for (Index const c : chosen)
      std::copy_n(row(c).sides, cells[at(c)].pattern().sides, std::back_inserter(list));
    return detail::each_once(std::move(list), sides.size());
  }

  /// The lists as loops see them, until one of them changes its size or makes entries its own.
  [[nodiscard]] TreeView view() const {
    return {cells.pages(), edges.pages(), sides.pages(),
            rows.pages(),  layout,        HostThreads::now() > 1};
  }
  /// See TreeView. Nobody may change it.
  [[nodiscard]] CellRow row(Index c) const { return view().row(c); }
  /// Appends cells, which have no value until they are edited.
  void extend_cells(std::size_t count) {
    cells.extend(count);
    rows.extend(layout.entry(count));
  }
  /// See TreeView.
  [[nodiscard]] CellNodeList nodes_of(Index c) const { return view().nodes_of(c); }

  /// Which cells, edges and sides are to be edited, for `own`: several threads may add to it at once.
  class Touched {
   public:
    explicit Touched(TreeLists const& lists)
        : lists_(lists), cells_(lists.cells), edges_(lists.edges), sides_(lists.sides) {}
    /// See TreeView::visit_parts.
    void add(Index c) {
      lists_.view().visit_parts(
          c, [&](Index cell) { cells_.add(at(cell)); }, [&](Index edge) { edges_.add(at(edge)); },
          [&](Index side) { sides_.add(at(side)); });
    }

   private:
    friend TreeLists;
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

  /// Before a division.
  void note_division() {
    divisions.add({static_cast<Index>(cells.size()), static_cast<Index>(edges.size()),
                   static_cast<Index>(sides.size()), nodes});
  }

  /// Counts a leaf at its edges, which become the tree's own, or with `by` = −1 no more.
  void count_leaf(Index c, int by) {
    for (std::size_t e = 0; e < at(cells[at(c)].pattern().edges); ++e)
      edges.edit(at(row(c).edges[e]));
    view().count_leaf(c, by);
  }
  /// Counts so many leaves with these nodes in all.
  void count_leaves(CellNodes has, Index by) {
    (has == CellNodes::corners ? linear_leaves : quadratic_leaves) += by;
  }

  /// Counts all leaves, and lists the cells of the initial mesh that have not what they had there.
  void find_degrees() {
    linear_leaves = quadratic_leaves = 0;
    converted.clear();
    for (Index c = 0; c < static_cast<Index>(cells.size()); ++c) {
      auto const& cell = cells[at(c)];
      if (is_leaf(c)) count_leaves(cell.has, 1);
      if (c < initial.cells && cell.has != cell.had) converted.push_back(c);
    }
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("cells", r.cells...);
    visit("edges", r.edges...);
    visit("sides", r.sides...);
    visit("rows of cells", r.rows...);
    visit("layout of rows", r.layout...);
    visit("divided cells", r.divided...);
    visit("cells of other degrees", r.converted...);
    visit("leaves with corners only", r.linear_leaves...);
    visit("other leaves", r.quadratic_leaves...);
    visit("initial mesh", r.initial...);
    visit("number of nodes", r.nodes...);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
};

}  // namespace pliant
