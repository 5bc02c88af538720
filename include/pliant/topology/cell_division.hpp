#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/topology/divided_sides.hpp>
#include <pliant/topology/division_plan.hpp>
#include <pliant/topology/element_nodes.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// Divides leaves of a tree as a plan says, on the threads of the host. Refers to both.
class CellDivision {
 public:
  CellDivision(TreeLists& lists, DivisionPlan& plan) : lists_(lists), plan_(plan) {}

  /// Gives the nodes that it makes: of each leaf the points of its pattern, in their order; then those of the children's
  /// elements.
  std::vector<PlacedNode> divide() {
    first_node_ = lists_.nodes;
    plan_.make_room();
    made_.resize(plan_.new_nodes());
    plan_.for_each([&](Index r) { make_on_edges(r); });
    plan_.for_each([&](Index r) { make_on_sides(r); });
    plan_.for_each([&](Index r) { make_children(r); });
    plan_.for_each([&](Index r) { count_uses(r); });
    std::vector<Index> quadratic;  // children
    for (Index r = 0; r < plan_.leaves(); ++r) {
      auto const& parent = plan_.cell(r);
      lists_.divided.push_back(plan_.leaf(r));
      lists_.count_leaves(parent.has, plan_.own(r).cells - 1);
      for (Index k = 0; parent.has != CellNodes::corners && k < plan_.own(r).cells; ++k)
        quadratic.push_back(parent.first_child + k);
    }
    ElementNodes::make(
        lists_, quadratic,
        [&](Index k) {
          auto const& child = lists_.cells[at(quadratic[at(k)])];
          auto const& parent = lists_.cells[at(child.parent)];
          CellPlacement place{.cell = child.parent, .had = parent.has};
          auto const& points = parent.divided().child[at(quadratic[at(k)] - parent.first_child)];
          for (std::size_t a = 0; a < child.corners(); ++a)
            place.corners[a] = parent.divided().place[at(points[a])];
          return place;
        },
        made_);
    return std::move(made_);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  template <class Bits>
  static bool has(Bits bits, std::size_t k) {
    return (bits >> k & 1) != 0;
  }
  /// How many bits are set below the k-th.
  template <class Bits>
  static Index rank(Bits bits, std::size_t k) {
    return std::popcount(static_cast<unsigned>(bits) & ((1u << k) - 1));
  }

  void place(Index r, Index node, int point) {
    made_[at(node - first_node_)] = {node, plan_.leaf(r), plan_.cell(r).has,
                                     plan_.pattern(r).place[at(point)]};
  }

  /// Middles and halves of edges.
  void make_on_edges(Index r) {
    auto const& leaf = plan_.cell(r);
    auto const& own = plan_.own(r);
    for (std::size_t e = 0; e < at(plan_.pattern(r).edges); ++e) {
      if (!has(own.middles, e) && !has(own.halves, e)) continue;
      Index const number = leaf.edges[e];
      auto& edge = lists_.edges.edit(at(number));
      if (has(own.middles, e)) {
        edge.middle = own.node + rank(own.middles, e);
        place(r, edge.middle, plan_.pattern(r).corners + static_cast<int>(e));
      }
      if (!has(own.halves, e)) continue;
      edge.first_half = own.edge + 2 * rank(own.halves, e);
      TreeEdge half{.parent = number, .level = edge.level + 1};
      half.nodes = {edge.nodes[0], edge.middle};
      lists_.edges.edit(at(edge.first_half)) = half;
      half.nodes = {edge.middle, edge.nodes[1]};
      lists_.edges.edit(at(edge.first_half + 1)) = half;
    }
  }
  /// Centres and parts of sides, whose edges have all of theirs.
  void make_on_sides(Index r) {
    auto const& leaf = plan_.cell(r);
    auto const& p = plan_.pattern(r);
    auto const& own = plan_.own(r);
    Index edge = own.edge + 2 * std::popcount(own.halves), part = own.side;
    for (std::size_t s = 0; s < at(p.sides); ++s) {
      if (has(own.centres, s)) {
        auto& centre = lists_.sides.edit(at(leaf.sides[s])).centre;
        centre = own.node + std::popcount(own.middles) + rank(own.centres, s);
        place(r, centre, p.side_centre[s]);
      }
      if (!has(own.parts, s)) continue;
      auto& side = lists_.sides.edit(at(leaf.sides[s]));
      side.first_child = part;
      side.first_inner_edge = edge;
      if (p.halves)
        divide_side(lists_, leaf.sides[s]);
      else
        halve_side(lists_, leaf.sides[s], leaf.nodes[at(p.child[0][0])]);
      auto const [parts, between] = DivisionPlan::parts_of(p, s);
      part += parts;
      edge += between;
    }
  }
  /// The cell's own node and edges, and its children, between what is on its edges and sides.
  void make_children(Index r) {
    Index const c = plan_.leaf(r);
    auto& parent = lists_.cells.edit(at(c));
    auto const& p = plan_.pattern(r);
    auto const& own = plan_.own(r);
    parent.division = plan_.division(r);
    parent.first_child = own.cell;
    if (p.centre >= 0 && parent.centre < 0) {
      parent.centre = own.node + own.nodes - 1;
      place(r, parent.centre, p.centre);
    }
    auto const point = points(parent, p);
    Index const inner_edge = own.edge + own.edges - p.inner_edges;
    int const level = parent.level + (p.halves ? 1 : 0);
    for (std::size_t i = 0; i < at(p.inner_edges); ++i)
      lists_.edges.edit(at(inner_edge) + i) = {
          .nodes = {point[at(p.inner_edge[i][0])], point[at(p.inner_edge[i][1])]},
          .cell = c,
          .level = level};
    Index next_inner_side = own.side + own.sides - p.inner_sides;
    std::array<Index, RefinementPattern::most_inner_sides> inner_side;
    inner_side.fill(-1);
    for (std::size_t i = 0; i < at(p.children); ++i) {
      Index const number = own.cell + static_cast<Index>(i);
      TreeCell child{.kind = p.child_kind[i],
                     .has = parent.has,
                     .mirrored = parent.mirrored != p.mirrored[i],
                     .level = level,
                     .parent = c};
      auto const& shape = child.pattern();
      for (std::size_t a = 0; a < child.corners(); ++a) child.nodes[a] = point[at(p.child[i][a])];
      for (std::size_t e = 0; e < at(shape.edges); ++e)
        child.edges[e] = edge_of_child(parent, child, e, p.child_edge[i][e], inner_edge);
      for (std::size_t s = 0; s < at(shape.sides); ++s) {
        auto const [home, k] = p.child_side[i][s];
        if (home == RefinementPattern::Home::side) {
          Index const whole = parent.sides[at(k)];
          child.sides[s] = DivisionPlan::is_divided(p, at(k))
                               ? part_of_side(lists_, whole, TreeLists::side_of(child, s))
                               : whole;
          lists_.sides.edit(at(child.sides[s])).cells[has(own.second, at(k)) ? 1 : 0] = number;
          continue;
        }
        bool const is_new = inner_side[at(k)] < 0;
        if (is_new) {
          inner_side[at(k)] = next_inner_side++;
          lists_.sides.edit(at(inner_side[at(k)])) = TreeLists::side_of(child, s);
        }
        child.sides[s] = inner_side[at(k)];
        lists_.sides.edit(at(child.sides[s])).cells[is_new ? 0 : 1] = number;
      }
      lists_.cells.edit(at(number)) = child;
    }
  }
  /// The nodes at the points of a leaf's pattern, as far as children have them for corners.
  [[nodiscard]] std::array<Index, RefinementPattern::most_points> points(
      TreeCell const& leaf, RefinementPattern const& p) const {
    std::array<Index, RefinementPattern::most_points> point{};
    std::copy_n(leaf.nodes.begin(), at(p.corners), point.begin());
    for (std::size_t e = 0; p.halves && e < at(p.edges); ++e)
      point[at(p.corners) + e] = lists_.edges[at(leaf.edges[e])].middle;
    for (std::size_t s = 0; p.halves && s < at(p.sides); ++s)
      if (p.side_centre[s] >= 0)
        point[at(p.side_centre[s])] = lists_.sides[at(leaf.sides[s])].centre;
    if (p.centre >= 0) point[at(p.centre)] = leaf.centre;
    return point;
  }
  [[nodiscard]] Index edge_of_child(TreeCell const& parent, TreeCell const& child, std::size_t e,
                                    RefinementPattern::Part part, Index first_inner_edge) const {
    if (part.home == RefinementPattern::Home::inside) return first_inner_edge + part.number;
    auto const& p = child.pattern();
    Index const a = child.nodes[at(p.edge[e][0])], b = child.nodes[at(p.edge[e][1])];
    if (part.home == RefinementPattern::Home::edge) {
      Index const whole = parent.edges[at(part.number)];
      if (!parent.divided().halves) return whole;
      auto const& ends = lists_.edges[at(whole)].nodes;
      return half_at(lists_, whole, a == ends[0] || a == ends[1] ? a : b);
    }
    return inner_edge_of_side(lists_, parent.sides[at(part.number)], {a, b});
  }

  void count_uses(Index r) {
    auto const& parent = plan_.cell(r);
    lists_.count_leaf(parent, -1);
    if (plan_.pattern(r).halves) lists_.count_refined(parent, 1);
    for (Index k = 0; k < plan_.own(r).cells; ++k)
      lists_.count_leaf(lists_.cells[at(parent.first_child + k)], 1);
  }

  TreeLists& lists_;
  DivisionPlan& plan_;
  Index first_node_ = 0;
  std::vector<PlacedNode> made_;
};

}  // namespace pliant::detail
