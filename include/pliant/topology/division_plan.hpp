#pragma once

#include <cstddef>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/topology/division_view.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// What it takes to divide leaves of a tree all at once, found on the threads of the host. What several of them share is
/// made by the one that comes first in the list, and new numbers ascend as the list does: they do not depend on the threads.
/// Refers to the tree's lists and to the leaves. Unless CellDivision divides them, the lists are as they were afterwards.
class DivisionPlan {
 public:
  /// Leaves, each once: refined are such as have no coarser neighbours but others of the list.
  DivisionPlan(TreeLists& lists, std::vector<CellSplit> const& leaves)
      : lists_(lists), leaves_(leaves), parts_(leaves.size()) {
    TreeLists::Touched touched(lists);
    for_each([&](Index r) { touched.add(leaves[at(r)].cell); });
    lists.own(touched);
    auto const division = view();
    for_each([&](Index r) { division.claim_shared(r); });
    for_each([&](Index r) { division.find_parts(r); });
    for (LeafParts const& own : parts_) {
      new_nodes_ += at(own.nodes);
      new_edges_ += at(own.edges);
      new_sides_ += at(own.sides);
      new_cells_ += at(own.cells);
    }
  }
  ~DivisionPlan() {
    auto const division = view();
    if (!divided_) for_each([&](Index r) { division.give_up_claims(r); });
  }
  DivisionPlan(DivisionPlan const&) = delete;
  DivisionPlan& operator=(DivisionPlan const&) = delete;

  /// How many there will be more; nodes between the corners of children's elements come beside these.
  [[nodiscard]] std::size_t new_nodes() const { return new_nodes_; }
  [[nodiscard]] std::size_t new_edges() const { return new_edges_; }
  [[nodiscard]] std::size_t new_cells() const { return new_cells_; }

  /// The leaves as loops see them, until the tree's lists change their size.
  [[nodiscard]] DivisionView view() { return {lists_.view(), leaves_.data(), parts_.data()}; }
  [[nodiscard]] Index leaves() const { return static_cast<Index>(leaves_.size()); }
  /// f(r) for each leaf, on the threads of the host.
  template <class F>
  void for_each(F const& f) const {
    for_each_on_host(leaves(), 256, f);
  }

  /// Makes room in the lists for what is new, and gives it numbers: now the leaves have to be divided.
  void make_room() {
    lists_.note_division();
    auto const next = [](Index& first, Index& end, Index count) {
      first = end;
      end += count;
    };
    auto edge = static_cast<Index>(lists_.edges.size()),
         side = static_cast<Index>(lists_.sides.size()),
         cell = static_cast<Index>(lists_.cells.size());
    for (LeafParts& own : parts_) {
      next(own.node, lists_.nodes, own.nodes);
      next(own.edge, edge, own.edges);
      next(own.side, side, own.sides);
      next(own.cell, cell, own.cells);
    }
    lists_.edges.extend(new_edges_);
    lists_.sides.extend(new_sides_);
    lists_.extend_cells(new_cells_);
    divided_ = true;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  TreeLists& lists_;
  std::vector<CellSplit> const& leaves_;
  std::vector<LeafParts> parts_;
  std::size_t new_nodes_ = 0, new_edges_ = 0, new_sides_ = 0, new_cells_ = 0;
  bool divided_ = false;
};

}  // namespace pliant::detail
