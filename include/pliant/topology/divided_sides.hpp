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

/// Fills the parts of a side whose edges are bisected, and which has its centre: four, and the edges between them. All is read
/// before anything is written, so that a device waits for memory seldom.
PLIANT_HOST_DEVICE void divide_side(TreeView const& tree, Index s) {
  using Four = std::array<Index, 4>;
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  TreeSide const side = tree.sides[at(s)];
  bool const quad = side.corners() == 4;
  Four middle{}, along{}, back{};  // back: the half of edge k at corner k + 1
  for (std::size_t k = 0; k < 4; ++k) {
    if (k == 3 && !quad) break;
    auto const& edge = tree.edges[at(side.edges[k])];
    bool const begins_here = edge.nodes[0] == side.nodes[k];
    middle[k] = edge.middle;
    along[k] = begins_here ? edge.first_half : edge.first_half + 1;
    back[k] = begins_here ? edge.first_half + 1 : edge.first_half;
  }
  Index const first = side.first_inner_edge;
  Four const inner{first, first + 1, first + 2, first + 3};
  auto const before = [&](Four const& own, std::size_t k) {
    return k > 0 ? own[k - 1] : quad ? own[3] : own[2];
  };
  TreeSide part{.parent = s, .level = side.level + 1};
  for (std::size_t k = 0; k < 4; ++k) {
    if (k == 3 && !quad) break;
    // Inner edge k joins the middle of edge k to the centre, or round corner k of a triangle.
    tree.edges[at(inner[k])] = {.nodes = {middle[k], quad ? side.centre : before(middle, k)},
                                .divided = s,
                                .home = TreeEdge::Home::side,
                                .level = static_cast<std::int16_t>(side.level + 1)};
    if (quad) {
      part.nodes = {side.nodes[k], middle[k], side.centre, before(middle, k)};
      part.edges = {along[k], inner[k], before(inner, k), before(back, k)};
    } else {
      part.nodes = {side.nodes[k], middle[k], before(middle, k), -1};
      part.edges = {along[k], inner[k], before(back, k), -1};
    }
    tree.sides[at(side.first_child) + k] = part;
  }
  if (quad) return;
  part.nodes = {middle[1], middle[2], middle[0], -1};
  part.edges = {inner[2], inner[0], inner[1], -1};
  tree.sides[at(side.first_child) + 3] = part;
}

/// The same of a side with four corners that is divided in two triangles, along the diagonal from one of them.
PLIANT_HOST_DEVICE void halve_side(TreeView const& tree, Index s, Index corner) {
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  auto const& side = tree.sides[at(s)];
  std::size_t const k = side.nodes[0] == corner || side.nodes[2] == corner ? 0 : 1;
  tree.edges[at(side.first_inner_edge)] = {.nodes = {side.nodes[k], side.nodes[k + 2]},
                                           .divided = s,
                                           .home = TreeEdge::Home::side,
                                           .level = static_cast<std::int16_t>(side.level)};
  for (std::size_t i = 0; i < 2; ++i) {
    std::size_t const a = k + 2 * i;
    tree.sides[at(side.first_child) + i] = {
        .nodes = {side.nodes[a], side.nodes[(a + 1) % 4], side.nodes[(a + 2) % 4], -1},
        .edges = {side.edges[a], side.edges[(a + 1) % 4], side.first_inner_edge, -1},
        .parent = s,
        .level = side.level};
  }
}

/// The edge between the parts of a side that is divided in four which joins the middles of two of its edges, or, where
/// `other` is negative, of one and the centre.
PLIANT_HOST_DEVICE Index inner_edge_of_side(TreeView const& tree, Index s, Index edge,
                                            Index other) {
  auto const& side = tree.sides[static_cast<std::size_t>(s)];
  Index k = 0, after = 0;
  while (side.edges[static_cast<std::size_t>(k)] != edge) ++k;
  if (other < 0) return side.first_inner_edge + k;
  while (side.edges[static_cast<std::size_t>(after)] != other) ++after;
  // Edge k and the one before it meet at corner k.
  return side.first_inner_edge + ((k + 2) % 3 == after ? k : after);
}

/// The part of a side that is divided in four which has the corners of another, of which only the one at corner k of the side
/// has that.
PLIANT_HOST_DEVICE Index quarter_of_side(TreeView const& tree, Index s,
                                         std::array<Index, 4> const& corners) {
  auto const& side = tree.sides[static_cast<std::size_t>(s)];
  Index part = 3;  // of a triangle, between the others
  for (std::size_t k = 0; k < 4; ++k)
    for (Index const node : corners)
      if (node >= 0 && node == side.nodes[k]) part = static_cast<Index>(k);
  return side.first_child + part;
}

/// The part of a halved side that has the corners of another.
PLIANT_HOST_DEVICE Index half_of_side(TreeView const& tree, Index s,
                                      std::array<Index, 4> const& corners) {
  Index part = tree.sides[static_cast<std::size_t>(s)].first_child;
  auto const has_all = [&](std::array<Index, 4> const& nodes) {
    for (Index const node : corners) {
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
