#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/backend/atomic.hpp>
#include <pliant/backend/host_array.hpp>
#include <pliant/error.hpp>
#include <pliant/math/first_of_each.hpp>
#include <pliant/math/unset_vector.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/group_numbers.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// Of the cells that a mesh has, and of what they are divided into.
template <class... Es>
RowLayout layout_of_rows(Mesh<Es...> const& mesh) {
  if constexpr (Mesh<Es...>::dim == 2) return RowLayout::of_plane_cells();
  bool const has_others = ((kind_of<typename Es::cell> != CellKind::tetrahedron &&
                            !mesh.template elements<Es>().empty()) ||
                           ...);
  return has_others ? RowLayout::of_solid_cells() : RowLayout::of_tetrahedra();
}

/// Finds the edges and sides of the cells of an initial mesh, on the threads of the host. They are numbered in the order in which
/// cells come to them.
template <int Dim>
class InitialCells {
 public:
  /// `others`: the nodes of elements that are no corners, of one cell after the other; each has one per edge, one per side with
  /// four corners and one in the middle, as far as it has them.
  InitialCells(TreeLists& lists, std::vector<Index> const& others)
      : lists_(lists), others_(others), first_other_(starts([](TreeCell const& cell) {
          auto const& p = cell.pattern();
          if (cell.has == CellNodes::corners) return 0;
          return p.edges + (cell.has == CellNodes::all ? sides_of_four(p) + (p.centre >= 0) : 0);
        })) {}

  /// Throws Error where more than two cells share a side, or two lie on the same side of an edge in the plane, or more share
  /// an edge than it can count.
  void join() {
    join_edges();
    if constexpr (Dim == 3) join_sides();
    for_each_cell([&](Index c) {
      auto& cell = lists_.cells.edited(at(c));
      if (cell.has == CellNodes::all && cell.pattern().centre >= 0)
        cell.centre = others_[at(first_other_[at(c) + 1]) - 1];
    });
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static int sides_of_four(RefinementPattern const& p) {
    int count = 0;
    for (int s = 0; s < p.sides; ++s) count += p.corners_of_side(s) == 4;
    return count;
  }
  [[nodiscard]] Index count() const { return static_cast<Index>(lists_.cells.size()); }
  template <class F>
  void for_each_cell(F const& f) const {
    for_each_on_host(count(), 1024, f);
  }
  /// Where what each cell has so many of begins, and behind the last.
  template <class Count>
  UnsetVector<Index> starts(Count const& count_of) const {
    return first_of_each(count(), [&](Index c) { return count_of(lists_.cells[at(c)]); });
  }

  void join_edges() {
    auto const first = starts([](TreeCell const& cell) { return cell.pattern().edges; });
    auto const view = lists_.view();
    auto const ends_of = [&](Index c, std::size_t e) {
      auto const& ends = lists_.cells[at(c)].pattern().edge[e];
      auto const* const nodes = view.row(c).nodes;
      return std::array{nodes[at(ends[0])], nodes[at(ends[1])]};
    };
    UnsetVector<std::array<Index, 2>> groups(at(first.back()));
    for_each_cell([&](Index c) {
      auto const& cell = lists_.cells[at(c)];
      for (std::size_t e = 0; e < at(cell.pattern().edges); ++e) {
        auto const ends = ends_of(c, e);
        groups[at(first[at(c)]) + e] = {std::min(ends[0], ends[1]), std::max(ends[0], ends[1])};
      }
    });
    auto const numbers = number_groups(groups, lists_.nodes);
    lists_.edges.extend(numbers.first.size());
    std::atomic<bool> overlap = false;
    for_each_cell([&](Index c) {
      auto* const edges = view.row(c).edges;
      for (std::size_t e = 0; e < at(lists_.cells[at(c)].pattern().edges); ++e) {
        Index const i = first[at(c)] + static_cast<Index>(e);
        edges[e] = numbers.number[at(i)];
        if (numbers.first[at(edges[e])] == i)
          lists_.edges.edited(at(edges[e])) = {.nodes = ends_of(c, e)};
      }
    });
    auto const counting = lists_.view();  // of the edges, too, and whether several threads count
    for_each_cell([&](Index c) {
      auto const& cell = lists_.cells[at(c)];
      auto const* const edges = view.row(c).edges;
      counting.count_leaf(c, 1);
      for (std::size_t e = 0; e < at(cell.pattern().edges); ++e) {
        auto& edge = lists_.edges.edited(at(edges[e]));
        if (cell.has != CellNodes::corners)
          atomic_store(edge.middle, others_[at(first_other_[at(c)]) + e]);
        bool const is_first = numbers.first[at(edges[e])] == first[at(c)] + static_cast<Index>(e);
        if (Dim == 2 && !is_first && edge.nodes == ends_of(c, e)) overlap = true;
      }
    });
    if (count() > most_at_edge && may_be_crowded(groups.size())) refuse_crowd_at_edge();
    if constexpr (Dim == 2) {
      for (auto const& edge : lists_.edges) overlap = overlap || edge.cells.leaves() > 2;
      if (overlap) refuse_overlap();
    }
  }
  /// Whether edges have not been counted by as many leaves as there are edges of leaves, or nearly too many.
  [[nodiscard]] bool may_be_crowded(std::size_t edges_of_leaves) const {
    std::atomic<std::size_t> counted = 0;
    std::atomic<bool> some = false;
    HostParts(static_cast<Index>(lists_.edges.size()))([&](Index from, Index to, int) {
      std::size_t own = 0;
      for (Index e = from; e < to; ++e) {
        auto const leaves = lists_.edges[at(e)].cells.leaves();
        own += at(leaves);
        if (leaves > most_at_edge) some = true;
      }
      counted += own;
    });
    return some || counted != edges_of_leaves;
  }
  void refuse_crowd_at_edge() const {
    std::vector<Index> cells_at(lists_.edges.size(), 0);
    for (Index c = 0; c < count(); ++c) {
      auto const own = lists_.row(c);
      for (std::size_t e = 0; e < at(lists_.cells[at(c)].pattern().edges); ++e) {
        auto const& edge = lists_.edges[at(own.edges[e])];
        if (++cells_at[at(own.edges[e])] > most_at_edge)
          throw Error("Hierarchy: cell ", c, " shares the edge from node ", edge.nodes[0], " to ",
                      edge.nodes[1], " with ", most_at_edge,
                      " others; give each edge that many cells at most");
      }
    }
  }
  /// Counter-clockwise neighbours run along their common edge in opposite directions.
  void refuse_overlap() const {
    std::vector<int> cells_at(lists_.edges.size(), 0);
    for (Index c = 0; c < count(); ++c) {
      auto const own = lists_.row(c);
      auto const& p = lists_.cells[at(c)].pattern();
      for (std::size_t e = 0; e < at(p.edges); ++e) {
        std::array const ends{own.nodes[at(p.edge[e][0])], own.nodes[at(p.edge[e][1])]};
        int const before = cells_at[at(own.edges[e])]++;
        if (before > 0 && (before > 1 || lists_.edges[at(own.edges[e])].nodes == ends))
          throw Error("Hierarchy: cell ", c, " overlaps another one at the edge from node ",
                      ends[0], " to ", ends[1], "; give each edge one cell on either side at most");
      }
    }
  }

  /// Of side s of a cell; −1 behind those of a triangle.
  static std::array<Index, 4> corners_of(CellRow const& cell, RefinementPattern const& p,
                                         std::size_t s) {
    std::array<Index, 4> nodes{-1, -1, -1, -1};
    for (std::size_t k = 0; k < 4; ++k)
      if (int const corner = p.side[s][k]; corner >= 0) nodes[k] = cell.nodes[at(corner)];
    return nodes;
  }
  /// Ascending; without a branch, which would go one way as often as the other.
  static std::array<Index, 4> sorted(std::array<Index, 4> nodes) {
    for (auto const& [a, b] : {std::pair{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}}) {
      Index const one = nodes[at(a)], other = nodes[at(b)];
      nodes[at(a)] = std::min(one, other);
      nodes[at(b)] = std::max(one, other);
    }
    return nodes;
  }
  void join_sides() {
    auto const first = starts([](TreeCell const& cell) { return cell.pattern().sides; });
    UnsetVector<std::array<Index, 4>> groups(at(first.back()));
    for_each_cell([&](Index c) {
      auto const& p = lists_.cells[at(c)].pattern();
      auto const own = lists_.row(c);
      for (std::size_t s = 0; s < at(p.sides); ++s)
        groups[at(first[at(c)]) + s] = sorted(corners_of(own, p, s));
    });
    auto const numbers = number_groups(groups, lists_.nodes);
    lists_.sides.extend(numbers.first.size());
    auto const view = lists_.view();
    HostArray<Index> cells_at(numbers.first.size());
    std::atomic<bool> crowded = false;
    // f(the number of a cell, the cell, which of its sides, that side's number, whether the cell is the first to have it)
    auto const for_each_side = [&](auto const& f) {
      for_each_cell([&](Index c) {
        auto const& cell = lists_.cells[at(c)];
        for (std::size_t s = 0; s < at(cell.pattern().sides); ++s) {
          Index const i = first[at(c)] + static_cast<Index>(s), number = numbers.number[at(i)];
          f(c, cell, s, number, numbers.first[at(number)] == i);
        }
      });
    };
    for_each_side([&](Index c, TreeCell const& cell, std::size_t s, Index number, bool is_first) {
      view.row(c).sides[s] = number;
      if (atomic_add(cells_at.data()[number], 1) >= 2) crowded = true;
      if (!is_first) return;
      auto& side = lists_.sides.edited(at(number));
      side = view.side_of(view.row(c), cell.level, s, cell.pattern());
      side.cells[0] = c;
    });
    if (crowded) refuse_crowd();
    for_each_side([&](Index c, TreeCell const& cell, std::size_t s, Index number, bool is_first) {
      auto& side = lists_.sides.edited(at(number));
      if (!is_first) side.cells[1] = c;
      auto const& p = cell.pattern();
      if (cell.has != CellNodes::all || p.corners_of_side(static_cast<int>(s)) != 4) return;
      std::size_t before = at(first_other_[at(c)]) + at(p.edges);
      for (std::size_t k = 0; k < s; ++k) before += p.corners_of_side(static_cast<int>(k)) == 4;
      atomic_store(side.centre, others_[before]);
    });
  }
  void refuse_crowd() const {
    std::vector<int> cells_at(lists_.sides.size(), 0);
    for (Index c = 0; c < count(); ++c) {
      auto const& cell = lists_.cells[at(c)];
      for (std::size_t s = 0; s < at(cell.pattern().sides); ++s) {
        if (++cells_at[at(lists_.row(c).sides[s])] <= 2) continue;
        auto const nodes = corners_of(lists_.row(c), cell.pattern(), s);
        throw Error("Hierarchy: cell ", c, " shares the side at the nodes ", nodes[0], ", ",
                    nodes[1], " and ", nodes[2],
                    " with two others; give each side two cells at most");
      }
    }
  }

  static constexpr Index most_at_edge =
      CellsAtEdge::most / 4;  // split, it may have four times as many

  TreeLists& lists_;
  std::vector<Index> const& others_;
  UnsetVector<Index> first_other_;
};

}  // namespace pliant::detail
