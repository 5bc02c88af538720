#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/topology/tree_lists.hpp>

namespace pliant::detail {

/// Divides the cells of a tree. Refers to its lists.
class CellDivision {
 public:
  explicit CellDivision(TreeLists& lists) : lists_(lists) {}

  /// Divides a leaf, to be refined one that has no coarser neighbour, and appends the nodes that it makes: the points of
  /// the pattern in their order, then those of the children's elements.
  void operator()(Index c, Division division, std::vector<PlacedNode>& made) {
    lists_.detach(c);
    lists_.cells.edit(at(c)).division = division;
    TreeCell const parent = lists_.cells[at(c)];
    auto const& p = parent.divided();
    std::array<Index, RefinementPattern::most_points> point{};
    auto const make_node = [&](Index& node, std::array<double, 3> const& place) {
      if (node >= 0) return;
      node = lists_.nodes++;
      made.push_back({node, c, parent.has, place});
    };
    std::copy_n(parent.nodes.begin(), at(p.corners), point.begin());
    for (std::size_t e = 0; p.halves && e < at(p.edges); ++e) {
      auto const k = at(p.corners) + e;
      make_node(lists_.edges.edit(at(parent.edges[e])).middle, p.place[k]);
      bisect(parent.edges[e]);
      point[k] = lists_.edges[at(parent.edges[e])].middle;
    }
    for (std::size_t s = 0; p.halves && s < at(p.sides); ++s) {
      if (p.side_centre[s] >= 0) {
        auto& centre = lists_.sides.edit(at(parent.sides[s])).centre;
        make_node(centre, p.place[at(p.side_centre[s])]);
        point[at(p.side_centre[s])] = centre;
      }
      divide_side(parent.sides[s]);
    }
    if (p.halved_side >= 0) halve_side(parent.sides[at(p.halved_side)], point[at(p.child[0][0])]);
    if (p.centre >= 0) {
      make_node(lists_.cells.edit(at(c)).centre, p.place[at(p.centre)]);
      point[at(p.centre)] = lists_.cells[at(c)].centre;
    }
    int const level = parent.level + (p.halves ? 1 : 0);
    auto const first_inner_edge = static_cast<Index>(lists_.edges.size());
    for (std::size_t i = 0; i < at(p.inner_edges); ++i)
      lists_.edges.push_back(
          {.nodes = {point[at(p.inner_edge[i][0])], point[at(p.inner_edge[i][1])]},
           .cell = c,
           .level = level});
    std::array<Index, RefinementPattern::most_inner_sides> inner_side;
    inner_side.fill(-1);

    auto const first_child = static_cast<Index>(lists_.cells.size());
    for (std::size_t i = 0; i < at(p.children); ++i) {
      TreeCell child{.kind = p.child_kind[i],
                     .has = parent.has,
                     .mirrored = parent.mirrored != p.mirrored[i],
                     .level = level,
                     .parent = c};
      auto const& own = child.pattern();
      for (std::size_t a = 0; a < child.corners(); ++a) child.nodes[a] = point[at(p.child[i][a])];
      for (std::size_t e = 0; e < at(own.edges); ++e)
        child.edges[e] = edge_of_child(parent, child, e, p.child_edge[i][e], first_inner_edge);
      for (std::size_t s = 0; s < at(own.sides); ++s) {
        auto const [home, number] = p.child_side[i][s];
        if (home == RefinementPattern::Home::side) {
          Index const whole = parent.sides[at(number)];
          child.sides[s] = p.halves || number == p.halved_side
                               ? part_of_side(whole, TreeLists::side_of(child, s))
                               : whole;
          continue;
        }
        if (inner_side[at(number)] < 0) {
          inner_side[at(number)] = static_cast<Index>(lists_.sides.size());
          lists_.sides.push_back(TreeLists::side_of(child, s));
        }
        child.sides[s] = inner_side[at(number)];
      }
      lists_.cells.push_back(child);
    }
    lists_.cells.edit(at(c)).first_child = first_child;
    lists_.divided.push_back(c);
    lists_.attach(c);
    for (Index child = first_child; child < first_child + p.children; ++child) {
      lists_.attach(child);
      if (parent.has != CellNodes::corners) place_nodes(child, c, make_node);
    }
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  void bisect(Index e) {
    auto const edge = lists_.edges[at(e)];
    if (edge.first_half >= 0) return;
    lists_.edges.edit(at(e)).first_half = static_cast<Index>(lists_.edges.size());
    TreeEdge half{.parent = e, .level = edge.level + 1};
    half.nodes = {edge.nodes[0], edge.middle};
    lists_.edges.push_back(half);
    half.nodes = {edge.middle, edge.nodes[1]};
    lists_.edges.push_back(half);
  }
  /// The half of a bisected edge that touches its end `node`.
  [[nodiscard]] Index half_at(Index e, Index node) const {
    auto const& edge = lists_.edges[at(e)];
    return edge.nodes[0] == node ? edge.first_half : edge.first_half + 1;
  }

  /// Divides a side whose edges are bisected, and which has its centre, in four.
  void divide_side(Index s) {
    auto const side = lists_.sides[at(s)];
    if (side.first_child >= 0) return;
    auto const n = side.corners();
    bool const quad = n == 4;
    auto const inner = static_cast<Index>(lists_.edges.size());
    lists_.sides.edit(at(s)).first_child = static_cast<Index>(lists_.sides.size());
    lists_.sides.edit(at(s)).first_inner_edge = inner;
    std::array<Index, 4> middle{};
    for (std::size_t k = 0; k < n; ++k) middle[k] = lists_.edges[at(side.edges[k])].middle;
    // Inner edge k joins the middle of edge k to the centre, or round corner k of a triangle.
    for (std::size_t k = 0; k < n; ++k)
      lists_.edges.push_back({.nodes = {middle[k], quad ? side.centre : middle[(k + n - 1) % n]},
                              .side = s,
                              .level = side.level + 1});
    TreeSide child{.parent = s, .level = side.level + 1};
    for (std::size_t k = 0; k < n; ++k) {
      auto const last = (k + n - 1) % n;
      Index const along = half_at(side.edges[k], side.nodes[k]),
                  back = half_at(side.edges[last], side.nodes[k]),
                  across = inner + static_cast<Index>(k);
      if (quad) {
        child.nodes = {side.nodes[k], middle[k], side.centre, middle[last]};
        child.edges = {along, across, inner + static_cast<Index>(last), back};
      } else {
        child.nodes = {side.nodes[k], middle[k], middle[last], -1};
        child.edges = {along, across, back, -1};
      }
      lists_.sides.push_back(child);
    }
    if (quad) return;
    child.nodes = {middle[1], middle[2], middle[0], -1};
    child.edges = {inner + 2, inner, inner + 1, -1};
    lists_.sides.push_back(child);
  }

  /// Divides a side with four corners in two triangles, along the diagonal from one of them.
  void halve_side(Index s, Index corner) {
    auto const side = lists_.sides[at(s)];
    if (side.first_child >= 0) return;
    std::size_t const k = side.nodes[0] == corner || side.nodes[2] == corner ? 0 : 1;
    auto const diagonal = static_cast<Index>(lists_.edges.size());
    lists_.edges.push_back(
        {.nodes = {side.nodes[k], side.nodes[k + 2]}, .side = s, .level = side.level});
    lists_.sides.edit(at(s)).first_child = static_cast<Index>(lists_.sides.size());
    lists_.sides.edit(at(s)).first_inner_edge = diagonal;
    for (std::size_t a = k; a < k + 3; a += 2)
      lists_.sides.push_back(
          {.nodes = {side.nodes[a], side.nodes[(a + 1) % 4], side.nodes[(a + 2) % 4], -1},
           .edges = {side.edges[a], side.edges[(a + 1) % 4], diagonal, -1},
           .parent = s,
           .level = side.level});
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
      return half_at(whole, a == ends[0] || a == ends[1] ? a : b);
    }
    auto const& side = lists_.sides[at(parent.sides[at(part.number)])];
    Index inner = side.first_inner_edge;
    auto const joins = [&](std::array<Index, 2> const& ends) {
      return (ends[0] == a && ends[1] == b) || (ends[0] == b && ends[1] == a);
    };
    while (!joins(lists_.edges[at(inner)].nodes)) ++inner;
    return inner;
  }
  /// The part of a divided side that has the corners of another.
  [[nodiscard]] Index part_of_side(Index s, TreeSide const& wanted) const {
    Index part = lists_.sides[at(s)].first_child;
    auto const has_all = [&](std::array<Index, 4> const& nodes) {
      return std::ranges::all_of(
          wanted.nodes, [&](Index node) { return std::ranges::find(nodes, node) != nodes.end(); });
    };
    while (!has_all(lists_.sides[at(part)].nodes)) ++part;
    return part;
  }

  /// Gives the element on a new child the nodes between its corners.
  template <class MakeNode>
  void place_nodes(Index child, Index parent, MakeNode const& make_node) {
    auto& cell = lists_.cells.edit(at(child));
    auto const& p = cell.pattern();
    auto const& divided = lists_.cells[at(parent)].divided();
    auto const& corner = divided.child[at(child - lists_.cells[at(parent)].first_child)];
    auto const mean = [&](auto const& corners, std::size_t count) {
      std::array<double, 3> sum{};
      for (std::size_t k = 0; k < count; ++k)
        for (std::size_t d = 0; d < 3; ++d)
          sum[d] += divided.place[at(corner[at(corners[k])])][d] / static_cast<double>(count);
      return sum;
    };
    for (std::size_t e = 0; e < at(p.edges); ++e)
      make_node(lists_.edges.edit(at(cell.edges[e])).middle, mean(p.edge[e], 2));
    if (cell.has != CellNodes::all) return;
    for (std::size_t s = 0; s < at(p.sides); ++s)
      if (p.side_centre[s] >= 0)
        make_node(lists_.sides.edit(at(cell.sides[s])).centre, mean(p.side[s], 4));
    if (p.centre < 0) return;
    std::array<int, 8> const corners{0, 1, 2, 3, 4, 5, 6, 7};
    make_node(cell.centre, mean(corners, at(p.corners)));
  }

  TreeLists& lists_;
};

}  // namespace pliant::detail
