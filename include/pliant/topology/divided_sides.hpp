#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <pliant/config.hpp>
#include <pliant/topology/tree_lists.hpp>

// Parts of edges and sides of a tree. Their numbers are known, and room for them is there.
namespace pliant::detail {

/// The half of a bisected edge that touches its end `node`.
inline Index half_at(TreeLists const& lists, Index e, Index node) {
  auto const& edge = lists.edges[static_cast<std::size_t>(e)];
  return edge.nodes[0] == node ? edge.first_half : edge.first_half + 1;
}

/// Fills the parts of a side whose edges are bisected, and which has its centre: four, and the edges between them.
inline void divide_side(TreeLists& lists, Index s) {
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  auto const& side = lists.sides[at(s)];
  auto const n = side.corners();
  bool const quad = n == 4;
  Index const inner = side.first_inner_edge;
  std::array<Index, 4> middle{};
  for (std::size_t k = 0; k < n; ++k) middle[k] = lists.edges[at(side.edges[k])].middle;
  // Inner edge k joins the middle of edge k to the centre, or round corner k of a triangle.
  for (std::size_t k = 0; k < n; ++k)
    lists.edges.edit(at(inner) + k) = {
        .nodes = {middle[k], quad ? side.centre : middle[(k + n - 1) % n]},
        .side = s,
        .level = side.level + 1};
  TreeSide part{.parent = s, .level = side.level + 1};
  for (std::size_t k = 0; k < n; ++k) {
    auto const last = (k + n - 1) % n;
    Index const along = half_at(lists, side.edges[k], side.nodes[k]),
                back = half_at(lists, side.edges[last], side.nodes[k]),
                across = inner + static_cast<Index>(k);
    if (quad) {
      part.nodes = {side.nodes[k], middle[k], side.centre, middle[last]};
      part.edges = {along, across, inner + static_cast<Index>(last), back};
    } else {
      part.nodes = {side.nodes[k], middle[k], middle[last], -1};
      part.edges = {along, across, back, -1};
    }
    lists.sides.edit(at(side.first_child) + k) = part;
  }
  if (quad) return;
  part.nodes = {middle[1], middle[2], middle[0], -1};
  part.edges = {inner + 2, inner, inner + 1, -1};
  lists.sides.edit(at(side.first_child) + 3) = part;
}

/// The same of a side with four corners that is divided in two triangles, along the diagonal from one of them.
inline void halve_side(TreeLists& lists, Index s, Index corner) {
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  auto const& side = lists.sides[at(s)];
  std::size_t const k = side.nodes[0] == corner || side.nodes[2] == corner ? 0 : 1;
  lists.edges.edit(at(side.first_inner_edge)) = {
      .nodes = {side.nodes[k], side.nodes[k + 2]}, .side = s, .level = side.level};
  for (std::size_t i = 0; i < 2; ++i) {
    std::size_t const a = k + 2 * i;
    lists.sides.edit(at(side.first_child) + i) = {
        .nodes = {side.nodes[a], side.nodes[(a + 1) % 4], side.nodes[(a + 2) % 4], -1},
        .edges = {side.edges[a], side.edges[(a + 1) % 4], side.first_inner_edge, -1},
        .parent = s,
        .level = side.level};
  }
}

/// The edge between the parts of a divided side that has these ends, in some order.
inline Index inner_edge_of_side(TreeLists const& lists, Index s, std::array<Index, 2> ends) {
  Index inner = lists.sides[static_cast<std::size_t>(s)].first_inner_edge;
  auto const joins = [&](std::array<Index, 2> const& own) {
    return own == ends || (own[0] == ends[1] && own[1] == ends[0]);
  };
  while (!joins(lists.edges[static_cast<std::size_t>(inner)].nodes)) ++inner;
  return inner;
}

/// The part of a divided side that has the corners of another.
inline Index part_of_side(TreeLists const& lists, Index s, TreeSide const& wanted) {
  Index part = lists.sides[static_cast<std::size_t>(s)].first_child;
  auto const has_all = [&](std::array<Index, 4> const& nodes) {
    return std::ranges::all_of(
        wanted.nodes, [&](Index node) { return std::ranges::find(nodes, node) != nodes.end(); });
  };
  while (!has_all(lists.sides[static_cast<std::size_t>(part)].nodes)) ++part;
  return part;
}

}  // namespace pliant::detail
