#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/error.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/topology/cell_division.hpp>
#include <pliant/topology/cell_merging.hpp>
#include <pliant/topology/cells_at_edges.hpp>
#include <pliant/topology/initial_cells.hpp>
#include <pliant/topology/tree_compaction.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant {

/// The cells, edges and sides of a mesh under refinement, without geometry: the topology of Hierarchy. Numbers ascend
/// from older to newer. Copies share what neither changes.
template <int Dim>
class CellTree {
 public:
  CellTree() = default;
  /// Of no cells yet, but of so many nodes.
  CellTree(Index nodes, RowLayout layout) {
    lists_.nodes = nodes;
    lists_.layout = layout;
  }
  /// Of lists that fit together; `at_edges`: of the same initial mesh, or null.
  CellTree(TreeLists lists, std::shared_ptr<CellsAtEdges const> at_edges)
      : lists_(std::move(lists)), at_edges_(std::move(at_edges)) {}

  /// Adds cells of the initial mesh, the nodes of each in the order of an element (see Element): corners,
  /// then one per edge, one per side with four corners, one in the middle, as far as it has them.
  template <std::size_t N>
  void add(CellKind kind, CellNodes has, std::vector<std::array<Index, N>> const& elements) {
    auto const corners = at(pattern_of(kind).corners);
    auto const others = N - corners, first = lists_.cells.size(),
               first_other = initial_others_.size();
    lists_.extend_cells(elements.size());
    auto const view = lists_.view();
    initial_others_.resize(first_other + others * elements.size());
    detail::for_each_on_host(size(elements), detail::few_elements(corners), [&](Index i) {
      auto const& nodes = elements[at(i)];
      auto const middle = nodes.begin() + static_cast<std::ptrdiff_t>(corners);
      CellNumbers numbers;
      std::copy(nodes.begin(), middle, numbers.nodes.begin());
      std::copy(
          middle, nodes.end(),
          initial_others_.begin() + static_cast<std::ptrdiff_t>(first_other + others * at(i)));
      lists_.cells.edited(first + at(i)) = {.kind = kind, .has = has, .had = has};
      detail::visit_cell(kind, [&]<class Cell>(Cell) {
        view.template put_row<Cell>(static_cast<Index>(first) + i, numbers);
      });
    });
    lists_.count_leaves(has, size(elements));
  }
  /// Ends the initial mesh, of which edges and sides are found. Throws Error where more than two cells share a side, or two
  /// lie on the same side of an edge in the plane.
  void seal() {
    detail::InitialCells<Dim>(lists_, initial_others_).join();
    initial_others_ = {};
    lists_.initial = {size(lists_.cells), size(lists_.edges), size(lists_.sides), lists_.nodes};
  }

  [[nodiscard]] TreeLists const& lists() const { return lists_; }
  [[nodiscard]] SharedList<TreeCell> const& cells() const { return lists_.cells; }
  [[nodiscard]] SharedList<TreeEdge> const& edges() const { return lists_.edges; }
  [[nodiscard]] SharedList<TreeSide> const& sides() const { return lists_.sides; }
  /// The cells that are divided, each once.
  [[nodiscard]] std::vector<Index> const& divided() const { return lists_.divided; }
  [[nodiscard]] TreeCell const& operator[](Index c) const { return lists_.cells[at(c)]; }
  /// The numbers of a cell's corners, edges and sides, which nobody may change.
  [[nodiscard]] CellRow row(Index c) const { return lists_.row(c); }
  [[nodiscard]] bool is_leaf(Index c) const { return lists_.is_leaf(c); }
  [[nodiscard]] std::size_t leaf_count() const {
    return at(lists_.linear_leaves) + at(lists_.quadratic_leaves);
  }
  [[nodiscard]] Index node_count() const { return lists_.nodes; }
  /// Those of the initial mesh, which stay.
  [[nodiscard]] Index initial_nodes() const { return lists_.initial.nodes; }
  /// Whether leaves with corners only are beside others, or cells of the initial mesh have not the nodes that they
  /// had there.
  [[nodiscard]] bool mixes_degrees() const {
    return (lists_.linear_leaves > 0 && lists_.quadratic_leaves > 0) || !lists_.converted.empty();
  }

  /// The edges of cells, each once, ascending.
  [[nodiscard]] std::vector<Index> edges_of(std::vector<Index> const& cells) const {
    return lists_.edges_of(cells);
  }
  /// The sides of solid cells, each once, ascending.
  [[nodiscard]] std::vector<Index> sides_of(std::vector<Index> const& cells) const {
    return lists_.sides_of(cells);
  }

  /// What `cells_at` looks for cells by, which takes a look at all cells of the initial mesh, or was kept.
  [[nodiscard]] std::shared_ptr<CellsAtEdges const> cells_at_edges() const {
    return at_edges_ ? at_edges_ : std::make_shared<CellsAtEdges const>(lists_);
  }
  /// Keeps that, for copies of the tree too.
  void keep_cells_at_edges() { at_edges_ = cells_at_edges(); }
  /// The cells that have an edge as a whole one, leaves and refined ones.
  [[nodiscard]] std::vector<Index> cells_at(CellsAtEdges const& by, Index e) const {
    return by.of(lists_, e);
  }

  /// What it takes to divide leaves. The tree and the list have to live longer.
  [[nodiscard]] detail::DivisionPlan plan_division(std::vector<CellSplit> const& leaves) {
    return {lists_, leaves};
  }
  /// Divides them, and gives the nodes that it makes.
  std::vector<PlacedNode> divide(detail::DivisionPlan& plan) {
    return detail::CellDivision{lists_, plan}.divide();
  }

  /// Whether the children of a divided cell are leaves of one degree, of a split one with corners only, that no neighbour
  /// keeps from being merged.
  [[nodiscard]] bool can_be_merged(Index c) const {
    return detail::can_be_merged(lists_.view(), c);
  }

  /// Gives leaves with corners only more nodes, and appends those that it makes.
  void raise(std::vector<CellConversion> const& conversions, std::vector<PlacedNode>& made) {
    std::vector<Index> cells;
    for (auto const& to : conversions) {
      convert(to);
      cells.push_back(to.cell);
    }
    detail::make_element_nodes(lists_, cells, false, made);
    forget_old_conversions();
  }

  /// Gives divided cells, each of which can be merged, the degree of their children.
  void take_degree_of_children(std::vector<Index> const& parents) {
    for (Index const c : parents) {
      auto const has = lists_.cells[at(lists_.cells[at(c)].first_child)].has;
      if (lists_.cells[at(c)].has != has) lists_.cells.edit(at(c)).has = has;
      note_conversion(c);
    }
    forget_old_conversions();
  }

  /// Makes divided cells, each of which can be merged and has the degree of its children, leaves again, and takes leaves
  /// the nodes between their corners. Nodes, cells, edges and sides that nothing uses any more go, but for those
  /// of the initial mesh; the others move up.
  Renumbering merge(std::vector<Index> const& parents, std::vector<Index> const& lowered = {}) {
    std::vector<Index> children;
    for (Index const c : parents)
      for (Index k = 0; k < lists_.cells[at(c)].divided().children; ++k)
        children.push_back(lists_.cells[at(c)].first_child + k);
    detail::CellMerging{lists_}(parents);
    auto touched = parents;
    for (Index const c : lowered) {
      convert({c, CellNodes::corners});
      touched.push_back(c);
    }
    std::erase_if(lists_.divided, [&](Index c) { return is_leaf(c); });
    auto renumbered = detail::TreeCompaction{lists_}(touched, std::move(children));
    forget_old_conversions();
    return renumbered;
  }

  /// The node at corner k of a side.
  [[nodiscard]] Index corner_of(TreeSide const& side, std::size_t k) const {
    return lists_.view().corner_of(side, k);
  }
  /// The nodes of the element on a cell, in the order of an element's whose corners its row has.
  [[nodiscard]] CellNodeList nodes_of(Index c) const { return lists_.nodes_of(c); }
  /// The same as the element has them, whose volume is positive.
  [[nodiscard]] CellNodeList element_nodes(Index c) const {
    auto list = nodes_of(c);
    if (lists_.cells[at(c)].mirrored) list.mirror();
    return list;
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    TreeLists::for_each_member(visit, r.lists_...);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index size(auto const& list) { return static_cast<Index>(list.size()); }

  void convert(CellConversion const& to) {
    auto& cell = lists_.cells.edit(at(to.cell));
    auto const count = [&](int by) {
      lists_.count_leaf(to.cell, by);
      lists_.count_leaves(cell.has, by);
    };
    count(-1);
    cell.has = to.has;
    count(1);
    note_conversion(to.cell);
  }
  void note_conversion(Index c) {
    if (c < lists_.initial.cells && lists_.cells[at(c)].has != lists_.cells[at(c)].had)
      lists_.converted.push_back(c);
  }
  void forget_old_conversions() {
    lists_.converted = detail::each_once(std::move(lists_.converted), lists_.cells.size());
    std::erase_if(lists_.converted,
                  [&](Index c) { return lists_.cells[at(c)].has == lists_.cells[at(c)].had; });
  }

  TreeLists lists_;
  std::shared_ptr<CellsAtEdges const> at_edges_;  // follows from the lists
  std::vector<Index> initial_others_;             // see InitialCells, until seal
};

}  // namespace pliant
