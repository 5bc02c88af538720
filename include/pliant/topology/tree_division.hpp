#pragma once

#include <array>
#include <cstddef>

#include <pliant/backend/backend.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/topology/element_nodes_on.hpp>
#include <pliant/topology/paged_tree.hpp>
#include <pliant/topology/part_numbers.hpp>
#include <pliant/topology/refinement_results.hpp>
#include <pliant/topology/tree_passes.hpp>

namespace pliant::detail {

/// Divides leaves of a tree in a backend's memory, as CellDivision does on the host. Has what passes take between them.
template <Backend B>
class TreeDivision {
 public:
  explicit TreeDivision(B const& backend) : backend_(backend), number_parts_(backend) {}

  /// Room for so many leaves, of which each is listed once.
  CellSplit* begin(Index leaves) {
    count_ = leaves;
    grow(backend_, leaves_, at(leaves));
    grow(backend_, parts_, at(leaves));
    return leaves_.data();
  }
  /// Marks the pages that the division of these edits.
  [[nodiscard]] LoopStep<MarkDivided> marking(PageMarks const& marks) const {
    // Few leaves leave threads to share them.
    Index const each = count_ <= TreeView::few ? MarkDivided::parts : 1;
    return {count_ * each, {leaves_.data(), marks, each}};
  }
  /// Numbers what they make, behind what there is, and checks it: check(how many nodes, edges, sides and cells), which may
  /// throw. Waits.
  template <class Check>
  void number(TreeView const& tree, TreeSizes const& sizes, Check const& check) {
    first_node_ = sizes.nodes;
    totals_ = number_parts_(backend_, view(tree), parts_.data(), count_, sizes);
    check(totals_);
  }
  /// Makes it.
  void make(PagedTree<B>& lists) {
    grow(backend_, made_, at(totals_[0]));
    lists.edges.reserve_extend(backend_, at(totals_[1]));
    lists.sides.reserve_extend(backend_, at(totals_[2]));
    lists.cells.reserve_extend(backend_, at(totals_[3]));
    lists.rows.reserve_extend(backend_, lists.layout.entry(at(totals_[3])));
    auto const edges = lists.edges.extend(backend_, at(totals_[1]));
    auto const sides = lists.sides.extend(backend_, at(totals_[2]));
    auto const cells = lists.cells.extend(backend_, at(totals_[3]));
    auto const rows = lists.rows.extend(backend_, lists.layout.entry(at(totals_[3])));
    auto const dividing = view(lists.view());
    in_turn(backend_, edges, sides, cells, rows, for_each_part(MakeOnEdges{dividing}),
            for_each_part(MakeOnSides{dividing}), LoopStep{count_, MakeInside{dividing}},
            for_each_part(MakeChildren{dividing}));
  }
  /// How many nodes children's elements need between their corners more. Waits.
  Index find_element_nodes(TreeView const& tree) {
    return element_nodes_.find(backend_, view(tree), count_);
  }
  /// Makes them, behind `known` others that the division made.
  void make_element_nodes(Index known, Index more) {
    grow_keeping(backend_, made_, at(known), at(known + more));
    element_nodes_.make(backend_, first_node_ + known, made_.data() + known);
  }

  [[nodiscard]] Index count() const { return count_; }
  [[nodiscard]] Index new_nodes() const { return totals_[0]; }
  [[nodiscard]] Index new_cells() const { return totals_[3]; }
  /// What was made, until the next division.
  [[nodiscard]] CellSplit const* leaves() const { return leaves_.data(); }
  [[nodiscard]] LeafParts const* parts() const { return parts_.data(); }
  [[nodiscard]] PlacedNode const* made() const { return made_.data(); }

 private:
  template <class U>
  using Array = typename B::template Array<U>;
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  [[nodiscard]] DivisionView view(TreeView const& tree) {
    return {tree, leaves_.data(), parts_.data(), first_node_, made_.data()};
  }
  /// For all edges, sides or children that leaves may have.
  template <class Make>
  [[nodiscard]] LoopStep<Make> for_each_part(Make const& make) const {
    return {count_ * Make::each, make};
  }

  B backend_;
  PartNumbers<B> number_parts_;
  Array<CellSplit> leaves_;
  Array<LeafParts> parts_;
  Array<PlacedNode> made_;
  ElementNodesOn<B> element_nodes_;
  Index count_ = 0, first_node_ = 0;
  std::array<Index, 4> totals_{};
};

}  // namespace pliant::detail
