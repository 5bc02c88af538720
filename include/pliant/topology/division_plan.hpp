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

/// What it takes to divide leaves of a tree all at once, found on the threads of the host. What several of them share is
/// made by the one that comes first in the list, and new numbers ascend as the list does: they do not depend on the threads.
/// Refers to the tree's lists and to the leaves. Unless CellDivision divides them, the lists are as they were afterwards.
class DivisionPlan {
 public:
  /// What a leaf makes, for others too: how many of each, and from which number on; edges, and sides, by a bit each.
  struct Own {
    std::uint16_t middles = 0, halves = 0;  // of edges
    std::uint8_t centres = 0, parts = 0;    // of sides
    std::uint8_t second = 0;                // sides of which it is the second cell
    Index nodes = 0, edges = 0, sides = 0, cells = 0;
    Index node = 0, edge = 0, side = 0, cell = 0;  // the first of them
  };

  /// Leaves, each once: refined are such as have no coarser neighbours but others of the list.
  DivisionPlan(TreeLists& lists, std::vector<CellSplit> const& leaves)
      : lists_(lists), leaves_(leaves), own_(leaves.size()) {
    TreeLists::Touched touched(lists);
    for_each([&](Index r) { touched.add(leaf(r)); });
    lists.own(touched);
    for_each([&](Index r) { visit_shared(r, [&](Index& number) { claim(number, r); }); });
    for_each([&](Index r) { own_[at(r)] = made_by(r); });
    for (Own const& own : own_) {
      new_nodes_ += at(own.nodes);
      new_edges_ += at(own.edges);
      new_sides_ += at(own.sides);
      new_cells_ += at(own.cells);
    }
  }
  ~DivisionPlan() {
    if (!divided_) for_each([&](Index r) { visit_shared(r, give_up_claim); });
  }
  DivisionPlan(DivisionPlan const&) = delete;
  DivisionPlan& operator=(DivisionPlan const&) = delete;

  /// How many there will be more; nodes between the corners of children's elements come beside these.
  [[nodiscard]] std::size_t new_nodes() const { return new_nodes_; }
  [[nodiscard]] std::size_t new_edges() const { return new_edges_; }
  [[nodiscard]] std::size_t new_cells() const { return new_cells_; }

  /// Of the r-th leaf.
  [[nodiscard]] Index leaf(Index r) const { return leaves_[at(r)].cell; }
  [[nodiscard]] TreeCell const& cell(Index r) const { return lists_.cells[at(leaf(r))]; }
  [[nodiscard]] Division division(Index r) const { return leaves_[at(r)].division; }
  [[nodiscard]] RefinementPattern const& pattern(Index r) const {
    return pattern_of(cell(r).kind, division(r));
  }
  [[nodiscard]] Own const& own(Index r) const { return own_[at(r)]; }
  [[nodiscard]] Index leaves() const { return static_cast<Index>(leaves_.size()); }
  /// f(r) for each leaf, on the threads of the host.
  template <class F>
  void for_each(F const& f) const {
    for_each_on_host(leaves(), 256, f);
  }

  static bool is_divided(RefinementPattern const& p, std::size_t side) {
    return p.halves || static_cast<int>(side) == p.halved_side;
  }
  /// Into how many parts a side is divided, and edges between these.
  static std::array<Index, 2> parts_of(RefinementPattern const& p, std::size_t side) {
    if (!p.halves) return {2, 1};
    return {4, p.corners_of_side(static_cast<int>(side))};
  }

  /// Makes room in the lists for what is new, and gives it numbers: now the leaves have to be divided.
  void make_room() {
    auto const next = [](Index& first, Index& end, Index count) {
      first = end;
      end += count;
    };
    auto edge = static_cast<Index>(lists_.edges.size()),
         side = static_cast<Index>(lists_.sides.size()),
         cell = static_cast<Index>(lists_.cells.size());
    for (Own& own : own_) {
      next(own.node, lists_.nodes, own.nodes);
      next(own.edge, edge, own.edges);
      next(own.side, side, own.sides);
      next(own.cell, cell, own.cells);
    }
    lists_.edges.extend(new_edges_);
    lists_.sides.extend(new_sides_);
    lists_.cells.extend(new_cells_);
    divided_ = true;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  /// visit(number) for what a leaf needs on its edges and sides, and others may need too: −1 where it is missing.
  template <class Visit>
  void visit_shared(Index r, Visit const& visit) {
    auto const& own_cell = cell(r);
    auto const& p = pattern(r);
    for (std::size_t e = 0; p.halves && e < at(p.edges); ++e) {
      auto& edge = lists_.edges.edit(at(own_cell.edges[e]));
      visit(edge.middle);
      visit(edge.first_half);
    }
    for (std::size_t s = 0; s < at(p.sides); ++s) {
      if (!is_divided(p, s)) continue;
      auto& side = lists_.sides.edit(at(own_cell.sides[s]));
      if (p.halves && p.side_centre[s] >= 0) visit(side.centre);
      visit(side.first_child);
    }
  }
  [[nodiscard]] Own made_by(Index r) const {
    auto const& own_cell = cell(r);
    auto const& p = pattern(r);
    Own own{.edges = p.inner_edges, .sides = p.inner_sides, .cells = p.children};
    for (std::size_t e = 0; p.halves && e < at(p.edges); ++e) {
      auto const& edge = lists_.edges[at(own_cell.edges[e])];
      own.middles |= static_cast<std::uint16_t>(makes(r, edge.middle) << e);
      own.halves |= static_cast<std::uint16_t>(makes(r, edge.first_half) << e);
    }
    for (std::size_t s = 0; s < at(p.sides); ++s) {
      auto const& side = lists_.sides[at(own_cell.sides[s])];
      own.second |= static_cast<std::uint8_t>(side.place_of(leaf(r)) << s);
      if (!is_divided(p, s)) continue;
      own.centres |= static_cast<std::uint8_t>(makes(r, side.centre) << s);
      if (!makes(r, side.first_child)) continue;
      own.parts |= static_cast<std::uint8_t>(1 << s);
      auto const [parts, between] = parts_of(p, s);
      own.sides += parts;
      own.edges += between;
    }
    own.edges += 2 * std::popcount(own.halves);
    own.nodes = std::popcount(own.middles) + std::popcount(own.centres);
    if (p.centre >= 0 && own_cell.centre < 0) ++own.nodes;
    return own;
  }

  TreeLists& lists_;
  std::vector<CellSplit> const& leaves_;
  std::vector<Own> own_;
  std::size_t new_nodes_ = 0, new_edges_ = 0, new_sides_ = 0, new_cells_ = 0;
  bool divided_ = false;
};

}  // namespace pliant::detail
