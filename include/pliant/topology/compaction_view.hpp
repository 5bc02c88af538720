#pragma once

#include <cstddef>

#include <pliant/config.hpp>
#include <pliant/topology/tree_view.hpp>

namespace pliant::detail {

/// New numbers of what stays, as all before `first` is; −1: gone.
struct NewNumbers {
  Index first = 0;
  Index const* others = nullptr;  // from `first` on

  PLIANT_HOST_DEVICE Index operator()(Index old) const {
    return old < first ? old : others[old - first];
  }
};

/// A tree of which cells became leaves, and leaves lost nodes, as loops see it that take away what nothing uses any more.
/// The first ones stay, with their numbers.
struct CompactionView {
  TreeView tree;      // before anything moves
  TreeSizes staying;  // so many of each, the first
  NewNumbers nodes{}, cells{}, edges{}, sides{};

  /// Children of leaves go.
  [[nodiscard]] PLIANT_HOST_DEVICE bool stays(Index c) const {
    return c < staying.cells || !tree.is_leaf(tree.cells[at(c)].parent);
  }
  [[nodiscard]] static PLIANT_HOST_DEVICE bool is_used(TreeEdge const& edge) {
    return edge.cells.leaves() + edge.cells.refined() > 0;
  }
  [[nodiscard]] static PLIANT_HOST_DEVICE bool is_used(TreeSide const& side) {
    return side.any_cell() >= 0;
  }
  /// use(k) for each node that the element on a cell has, if it is node k behind those that stay.
  template <class Use>
  PLIANT_HOST_DEVICE void use_nodes_of(Index c, Use const& use) const {
    auto const list = tree.nodes_of(c);
    for (std::size_t i = 0; i < list.count; ++i)
      if (list[i] >= staying.nodes) use(list[i] - staying.nodes);
  }

  /// visit(node) for the nodes that divided a cell that is a leaf now, and divide no other one; −1: none. All elements have
  /// corners only.
  template <class Visit>
  static PLIANT_HOST_DEVICE void visit_nodes_that_go(TreeView const& tree, Index c,
                                                     Visit const& visit) {
    auto const own = tree.row(c);
    auto const& cell = tree.cells[at(c)];
    auto const& p = cell.pattern();
    for (std::size_t e = 0; e < at(p.edges); ++e)
      if (auto const& edge = tree.edges[at(own.edges[e])]; edge.cells.refined() == 0)
        visit(edge.middle);
    for (std::size_t s = 0; s < at(p.sides); ++s)
      if (auto const& side = tree.sides[at(own.sides[s])]; !is_divided(tree, side))
        visit(side.centre);
    visit(cell.centre);
  }
  /// Whether a cell at a side is divided.
  static PLIANT_HOST_DEVICE bool is_divided(TreeView const& tree, TreeSide const& side) {
    for (Index const c : side.cells)
      if (c >= 0 && !tree.is_leaf(c)) return true;
    return false;
  }

  /// New numbers in what an entry that stays where it is knows of others.
  PLIANT_HOST_DEVICE void renumber_within(TreeCell& cell) const {
    move(cell.first_child, cells);
    move(cell.centre, nodes);
  }
  PLIANT_HOST_DEVICE void renumber_within(TreeEdge& edge) const {
    if (edge.cells.refined() == 0) edge.first_half = -1;
    move(edge.middle, nodes);
    move(edge.first_half, edges);
  }
  PLIANT_HOST_DEVICE void renumber_within(TreeSide& side) const {
    if (side.first_inner_edge >= 0 && !is_divided(tree, side))
      side.first_child = side.first_inner_edge = -1;
    move(side.centre, nodes);
    move(side.first_child, sides);
    move(side.first_inner_edge, edges);
    move_all(side.cells, cells);  // parts of split cells among them
  }

  /// New numbers in an entry that came later.
  PLIANT_HOST_DEVICE void renumber(TreeCell& cell) const {
    renumber_within(cell);
    move(cell.parent, cells);
  }
  /// Entry k of a row.
  PLIANT_HOST_DEVICE void renumber(RowEntry& entry, Index k) const {
    auto const& layout = tree.layout;
    for (std::size_t i = 0; i < RowEntry::count; ++i) {
      Index const place = static_cast<Index>(RowEntry::count) * k + static_cast<Index>(i);
      move(entry.numbers[i], place < layout.first_edge   ? nodes
                             : place < layout.first_side ? edges
                                                         : sides);
    }
  }
  PLIANT_HOST_DEVICE void renumber(TreeEdge& edge) const {
    renumber_within(edge);
    using Home = TreeEdge::Home;
    move(edge.divided, edge.home == Home::edge ? edges : edge.home == Home::side ? sides : cells);
    move_all(edge.nodes, nodes);
  }
  PLIANT_HOST_DEVICE void renumber(TreeSide& side) const {
    renumber_within(side);
    move(side.parent, sides);
    move_all(side.edges, edges);
  }

 private:
  static PLIANT_HOST_DEVICE std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static PLIANT_HOST_DEVICE void move(Index& number, NewNumbers const& to) { number = to(number); }
  template <class Numbers>
  static PLIANT_HOST_DEVICE void move_all(Numbers& numbers, NewNumbers const& to) {
    for (Index& number : numbers) move(number, to);
  }
};

}  // namespace pliant::detail
