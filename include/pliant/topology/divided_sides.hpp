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
    Index const backwards = side.runs_backwards(k) ? 1 : 0;
    middle[k] = edge.middle;
    along[k] = edge.first_half + backwards;
    back[k] = edge.first_half + 1 - backwards;
  }
  Index const first = side.first_inner_edge;
  Four const inner{first, first + 1, first + 2, first + 3};
  auto const before = [&](Four const& own, std::size_t k) {
    return k > 0 ? own[k - 1] : quad ? own[3] : own[2];
  };
  auto const level = static_cast<std::int16_t>(side.level + 1);
  TreeSide part{.parent = s, .level = level};
  for (std::size_t k = 0; k < 4; ++k) {
    if (k == 3 && !quad) break;
    // Inner edge k joins the middle of edge k to the centre, or round corner k of a triangle.
    tree.edges[at(inner[k])] = {.nodes = {middle[k], quad ? side.centre : before(middle, k)},
                                .divided = s,
                                .home = TreeEdge::Home::side,
                                .level = level};
    // Halves run as their edge does, and inner edges from the middle of theirs.
    unsigned const along_backwards = side.runs_backwards(k),
                   back_backwards = side.runs_backwards(k > 0 ? k - 1 : side.corners() - 1);
    if (quad) {
      part.edges = {along[k], inner[k], before(inner, k), before(back, k)};
      part.backwards = static_cast<std::uint16_t>(along_backwards | 1u << 2 | back_backwards << 3);
    } else {
      part.edges = {along[k], inner[k], before(back, k), -1};
      part.backwards = static_cast<std::uint16_t>(along_backwards | back_backwards << 2);
    }
    tree.sides[at(side.first_child) + k] = part;
  }
  if (quad) return;
  part.edges = {inner[2], inner[0], inner[1], -1};
  part.backwards = 7;
  tree.sides[at(side.first_child) + 3] = part;
}

/// The same of a side with four corners that is divided in two triangles, along the diagonal from one of them.
PLIANT_HOST_DEVICE void halve_side(TreeView const& tree, Index s, Index corner) {
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  auto const& side = tree.sides[at(s)];
  auto const nodes = tree.corners_of(side);
  std::size_t const k = nodes[0] == corner || nodes[2] == corner ? 0 : 1;
  tree.edges[at(side.first_inner_edge)] = {.nodes = {nodes[k], nodes[k + 2]},
                                           .divided = s,
                                           .home = TreeEdge::Home::side,
                                           .level = side.level};
  for (std::size_t i = 0; i < 2; ++i) {
    std::size_t const a = k + 2 * i, b = (a + 1) % 4;
    unsigned const a_backwards = side.runs_backwards(a), b_backwards = side.runs_backwards(b),
                   diagonal_backwards = i == 0;  // it runs from corner k
    tree.sides[at(side.first_child) + i] = {
        .edges = {side.edges[a], side.edges[b], side.first_inner_edge, -1},
        .parent = s,
        .level = side.level,
        .backwards =
            static_cast<std::uint16_t>(a_backwards | b_backwards << 1 | diagonal_backwards << 2)};
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

/// The part of a side that is divided in four at the corner where two of its edges meet.
PLIANT_HOST_DEVICE Index quarter_of_side(TreeView const& tree, Index s, Index edge, Index other) {
  auto const& side = tree.sides[static_cast<std::size_t>(s)];
  Index before = side.edges[side.corners() - 1], part = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    Index const own = side.edges[k];
    if ((own == edge && before == other) || (own == other && before == edge))
      part = static_cast<Index>(k);
    before = own;
  }
  return side.first_child + part;
}

/// The part of a halved side that has one of these edges, of which one is the diagonal.
PLIANT_HOST_DEVICE Index half_of_side(TreeView const& tree, Index s,
                                      std::array<Index, 3> const& edges) {
  Index const first = tree.sides[static_cast<std::size_t>(s)].first_child;
  for (Index const edge : edges)
    if (edge == tree.sides[static_cast<std::size_t>(first)].edges[0]) return first;
  return first + 1;
}

}  // namespace pliant::detail
