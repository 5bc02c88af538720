#pragma once

#include <array>
#include <cstddef>

#include <pliant/config.hpp>
#include <pliant/topology/tree_view.hpp>

// Parts of edges and sides of a tree. Their numbers are known, and room for them is there.
namespace pliant::detail {

/// The half of a bisected edge that touches its end `node`.
PLIANT_HOST_DEVICE Index half_at(TreeView const& tree, Index e, Index node) {
  auto const& edge = tree.edges[static_cast<std::size_t>(e)];
  return edge.nodes[0] == node ? edge.first_half : edge.first_half + 1;
}

/// Fills the parts of a side whose edges are bisected, and which has its centre: four, and the edges between them.
PLIANT_HOST_DEVICE void divide_side(TreeView const& tree, Index s) {
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  auto const& side = tree.sides[at(s)];
  auto const n = side.corners();
  bool const quad = n == 4;
  Index const inner = side.first_inner_edge;
  std::array<Index, 4> middle{};
  for (std::size_t k = 0; k < n; ++k) middle[k] = tree.edges[at(side.edges[k])].middle;
  // Inner edge k joins the middle of edge k to the centre, or round corner k of a triangle.
  for (std::size_t k = 0; k < n; ++k)
    tree.edges[at(inner) + k] = {.nodes = {middle[k], quad ? side.centre : middle[(k + n - 1) % n]},
                                 .side = s,
                                 .level = side.level + 1};
  TreeSide part{.parent = s, .level = side.level + 1};
  for (std::size_t k = 0; k < n; ++k) {
    auto const last = (k + n - 1) % n;
    Index const along = half_at(tree, side.edges[k], side.nodes[k]),
                back = half_at(tree, side.edges[last], side.nodes[k]),
                across = inner + static_cast<Index>(k);
    if (quad) {
      part.nodes = {side.nodes[k], middle[k], side.centre, middle[last]};
      part.edges = {along, across, inner + static_cast<Index>(last), back};
    } else {
      part.nodes = {side.nodes[k], middle[k], middle[last], -1};
      part.edges = {along, across, back, -1};
    }
    tree.sides[at(side.first_child) + k] = part;
  }
  if (quad) return;
  part.nodes = {middle[1], middle[2], middle[0], -1};
  part.edges = {inner + 2, inner, inner + 1, -1};
  tree.sides[at(side.first_child) + 3] = part;
}

/// The same of a side with four corners that is divided in two triangles, along the diagonal from one of them.
PLIANT_HOST_DEVICE void halve_side(TreeView const& tree, Index s, Index corner) {
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  auto const& side = tree.sides[at(s)];
  std::size_t const k = side.nodes[0] == corner || side.nodes[2] == corner ? 0 : 1;
  tree.edges[at(side.first_inner_edge)] = {
      .nodes = {side.nodes[k], side.nodes[k + 2]}, .side = s, .level = side.level};
  for (std::size_t i = 0; i < 2; ++i) {
    std::size_t const a = k + 2 * i;
    tree.sides[at(side.first_child) + i] = {
        .nodes = {side.nodes[a], side.nodes[(a + 1) % 4], side.nodes[(a + 2) % 4], -1},
        .edges = {side.edges[a], side.edges[(a + 1) % 4], side.first_inner_edge, -1},
        .parent = s,
        .level = side.level};
  }
}

/// The edge between the parts of a divided side that has these ends, in some order.
PLIANT_HOST_DEVICE Index inner_edge_of_side(TreeView const& tree, Index s, Index a, Index b) {
  Index inner = tree.sides[static_cast<std::size_t>(s)].first_inner_edge;
  auto const joins = [&](std::array<Index, 2> const& own) {
    return (own[0] == a && own[1] == b) || (own[0] == b && own[1] == a);
  };
  while (!joins(tree.edges[static_cast<std::size_t>(inner)].nodes)) ++inner;
  return inner;
}

/// The part of a divided side that has the corners of another.
PLIANT_HOST_DEVICE Index part_of_side(TreeView const& tree, Index s, TreeSide const& wanted) {
  Index part = tree.sides[static_cast<std::size_t>(s)].first_child;
  auto const has_all = [&](std::array<Index, 4> const& nodes) {
    for (Index const node : wanted.nodes) {
      bool has = false;
      for (Index const own : nodes) has = has || own == node;
      if (!has) return false;
    }
    return true;
  };
  while (!has_all(tree.sides[static_cast<std::size_t>(part)].nodes)) ++part;
  return part;
}

}  // namespace pliant::detail
