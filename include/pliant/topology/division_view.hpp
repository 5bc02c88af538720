#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include <pliant/config.hpp>
#include <pliant/topology/divided_sides.hpp>
#include <pliant/topology/tree_claims.hpp>
#include <pliant/topology/tree_view.hpp>

namespace pliant::detail {

/// What a leaf makes when it is divided, for others too: how many of each, and from which number on; edges, and sides, by a
/// bit each.
struct LeafParts {
  std::uint16_t middles = 0, halves = 0;  // of edges
  std::uint8_t centres = 0, parts = 0;    // of sides
  std::uint8_t second = 0;                // sides of which it is the second cell
  Index nodes = 0, edges = 0, sides = 0, cells = 0;
  Index node = 0, edge = 0, side = 0, cell = 0;  // the first of them
};

/// Leaves of a tree that are divided, each once, as loops over them see them: one call of each function for each leaf, which
/// is told by its place in the list. First all claim, then all count; with numbers for what is new, and room for it, come
/// what is on edges, on sides and inside, one after the other, then children: for each edge, side and child one call.
struct DivisionView {
  TreeView tree;
  CellSplit const* leaves;
  LeafParts* parts;
  Index first_node = 0;        // that is new
  PlacedNode* made = nullptr;  // by nodes, from that on

  [[nodiscard]] PLIANT_HOST_DEVICE Index leaf(Index r) const { return leaves[r].cell; }
  [[nodiscard]] PLIANT_HOST_DEVICE TreeCell& cell(Index r) const { return tree.cells[at(leaf(r))]; }
  [[nodiscard]] PLIANT_HOST_DEVICE CellRow row(Index r) const { return tree.row(leaf(r)); }
  [[nodiscard]] PLIANT_HOST_DEVICE RefinementPattern const& pattern_at(Index r) const {
    return pattern_of(cell(r).kind, leaves[r].division);
  }
  static PLIANT_HOST_DEVICE bool is_divided(RefinementPattern const& p, std::size_t side) {
    return p.halves || static_cast<int>(side) == p.halved_side;
  }
  /// Into how many parts a side is divided, and edges between these.
  static PLIANT_HOST_DEVICE std::array<Index, 2> parts_of(RefinementPattern const& p,
                                                          std::size_t side) {
    if (!p.halves) return {2, 1};
    return {4, p.corners_of_side(static_cast<int>(side))};
  }

  /// Claims what the leaf needs on its edges and sides, and others may need too, as far as it is missing.
  PLIANT_HOST_DEVICE void claim_shared(Index r) const {
    visit_shared(r, [&](Index& number) { claim(number, r, tree.shared); });
  }
  /// Takes the claims on these back.
  PLIANT_HOST_DEVICE void give_up_claims(Index r) const {
    visit_shared(r, [](Index& number) { give_up_claim(number); });
  }
  /// Finds what the leaf makes; numbers are not known yet.
  PLIANT_HOST_DEVICE void find_parts(Index r) const {
    auto const own_row = row(r);
    auto const& p = pattern_at(r);
    LeafParts own{.edges = p.inner_edges, .sides = p.inner_sides, .cells = p.children};
    for (std::size_t e = 0; p.halves && e < at(p.edges); ++e) {
      auto const& edge = tree.edges[at(own_row.edges[e])];
      own.middles |= static_cast<std::uint16_t>(makes(r, edge.middle) << e);
      own.halves |= static_cast<std::uint16_t>(makes(r, edge.first_half) << e);
    }
    for (std::size_t s = 0; s < at(p.sides); ++s) {
      auto const& side = tree.sides[at(own_row.sides[s])];
      own.second |= static_cast<std::uint8_t>(side.place_of(leaf(r)) << s);
      if (!is_divided(p, s)) continue;
      own.centres |= static_cast<std::uint8_t>(makes(r, side.centre) << s);
      if (!makes(r, side.first_child)) continue;
      own.parts |= static_cast<std::uint8_t>(1 << s);
      auto const counts = parts_of(p, s);
      own.sides += counts[0];
      own.edges += counts[1];
    }
    own.edges += 2 * std::popcount(own.halves);
    own.nodes = std::popcount(own.middles) + std::popcount(own.centres);
    if (p.centre >= 0 && cell(r).centre < 0) ++own.nodes;
    parts[r] = own;
  }

  /// Middle and halves of edge e.
  PLIANT_HOST_DEVICE void make_on_edge(Index r, std::size_t e) const {
    auto const& own = parts[r];
    if (!has(own.middles, e) && !has(own.halves, e)) return;  // as most, by one look at memory
    Index const number = row(r).edges[e];
    auto& edge = tree.edges[at(number)];
    TreeEdge const whole = edge;  // all of it first, so that a device waits for memory once
    Index middle = whole.middle;
    if (has(own.middles, e)) {
      edge.middle = middle = own.node + rank(own.middles, e);
      place(r, middle, pattern_at(r).corners + static_cast<int>(e));
    }
    if (!has(own.halves, e)) return;
    Index const first = own.edge + 2 * rank(own.halves, e);
    edge.first_half = first;
    TreeEdge half{.divided = number, .level = static_cast<std::int16_t>(whole.level + 1)};
    half.nodes = {whole.nodes[0], middle};
    tree.edges[at(first)] = half;
    half.nodes = {middle, whole.nodes[1]};
    tree.edges[at(first + 1)] = half;
  }
  /// Centre and parts of side s, whose edges have all of theirs.
  PLIANT_HOST_DEVICE void make_on_side(Index r, std::size_t s) const {
    auto const& own = parts[r];
    if (!has(own.centres, s) && !has(own.parts, s)) return;
    auto const own_row = row(r);
    auto const& p = pattern_at(r);
    auto& side = tree.sides[at(own_row.sides[s])];
    if (has(own.centres, s)) {
      side.centre = own.node + std::popcount(own.middles) + rank(own.centres, s);
      place(r, side.centre, p.side_centre[s]);
    }
    if (!has(own.parts, s)) return;
    Index edge = own.edge + 2 * std::popcount(own.halves), part = own.side;
    for (std::size_t before = 0; before < s; ++before) {
      if (!has(own.parts, before)) continue;
      auto const counts = parts_of(p, before);
      part += counts[0];
      edge += counts[1];
    }
    side.first_child = part;
    side.first_inner_edge = edge;
    if (p.halves)
      divide_side(tree, own_row.sides[s]);
    else
      halve_side(tree, own_row.sides[s], own_row.nodes[at(p.child[0][0])]);
  }
  /// The cell's own node and edges, between what is on its edges and sides. It is no leaf any more.
  PLIANT_HOST_DEVICE void make_inside(Index r) const {
    Index const c = leaf(r);
    auto& parent = tree.cells[at(c)];
    auto const& p = pattern_at(r);
    auto const& own = parts[r];
    parent.division = leaves[r].division;
    parent.first_child = own.cell;
    if (p.centre >= 0 && parent.centre < 0) {
      parent.centre = own.node + own.nodes - 1;
      place(r, parent.centre, p.centre);
    }
    Index const inner_edge = first_inner_edge(own, p);
    for (std::size_t i = 0; i < at(p.inner_edges); ++i)
      tree.edges[at(inner_edge) + i] = {
          .nodes = {point(c, p, p.inner_edge[i][0]), point(c, p, p.inner_edge[i][1])},
          .divided = c,
          .home = TreeEdge::Home::cell,
          .level = level_of_children(parent, p)};
    tree.count_leaf(c, -1);
    if (p.halves) tree.count_refined(c, 1);
  }
  /// Child i, which is a leaf, and the sides inside of which it is the first cell.
  PLIANT_HOST_DEVICE void make_child(Index r, std::size_t i) const {
    visit_cell(pattern_at(r).child_kind[i], [&]<class Cell>(Cell) { make_child_on<Cell>(r, i); });
  }

 private:
  static PLIANT_HOST_DEVICE std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  /// Child i, which is a `Cell`: compilers know how many of each it has, so that a device keeps it in registers.
  template <class Cell>
  PLIANT_HOST_DEVICE void make_child_on(Index r, std::size_t i) const {
    Index const c = leaf(r);
    auto const& parent = tree.cells[at(c)];
    auto const& p = pattern_at(r);
    auto const& own = parts[r];
    Index const number = own.cell + static_cast<Index>(i);
    TreeCell child{.kind = kind_of<Cell>,
                   .has = parent.has,
                   .mirrored = parent.mirrored != p.mirrored[i],
                   .level = level_of_children(parent, p),
                   .parent = c};
    auto const& shape = pattern_of(kind_of<Cell>);
    CellNumbers numbers;
    auto const around = tree.row(c);
    for (std::size_t a = 0; a < Cell::corners; ++a) numbers.nodes[a] = point(c, p, p.child[i][a]);
    for (std::size_t e = 0; e < Cell::edges().size(); ++e)
      numbers.edges[e] = edge_of_child(around, p, p.child[i][at(shape.edge[e][0])],
                                       p.child[i][at(shape.edge[e][1])], p.child_edge[i][e],
                                       first_inner_edge(own, p));
    for (int k = 0; k < sides_of<Cell>; ++k) {
      auto const s = at(k);
      auto const& of_parent = p.child_side[i][s];
      auto const there = at(of_parent.number);
      if (of_parent.home == RefinementPattern::Home::side) {
        numbers.sides[s] = side_of_child(around, p, of_parent, numbers, shape.edges_of_side[s]);
        tree.sides[at(numbers.sides[s])].cells[has(own.second, there) ? 1 : 0] = number;
        continue;
      }
      numbers.sides[s] = own.side + own.sides - p.inner_sides + of_parent.number;
      auto const& children = p.children_at_inner_side[there];
      if (at(children[0]) != i) continue;
      auto side = tree.side_of(numbers.row(), child.level, s, shape);
      side.cells = {own.cell + children[0], own.cell + children[1]};
      tree.sides[at(numbers.sides[s])] = side;
    }
    tree.cells[at(number)] = child;
    tree.put_row<Cell>(number, numbers);
    tree.count_child<Cell>(numbers.edges.data(), p, i, child.has, 1);
  }
  template <class Bits>
  static PLIANT_HOST_DEVICE bool has(Bits bits, std::size_t k) {
    return (bits >> k & 1) != 0;
  }
  /// How many bits are set below the k-th.
  template <class Bits>
  static PLIANT_HOST_DEVICE Index rank(Bits bits, std::size_t k) {
    return std::popcount(static_cast<unsigned>(bits) & ((1u << k) - 1));
  }

  /// visit(number) for what a leaf needs on its edges and sides, and others may need too: −1 where it is missing.
  template <class Visit>
  PLIANT_HOST_DEVICE void visit_shared(Index r, Visit const& visit) const {
    auto const own_row = row(r);
    auto const& p = pattern_at(r);
    for (std::size_t e = 0; p.halves && e < at(p.edges); ++e) {
      auto& edge = tree.edges[at(own_row.edges[e])];
      visit(edge.middle);
      visit(edge.first_half);
    }
    for (std::size_t s = 0; s < at(p.sides); ++s) {
      if (!is_divided(p, s)) continue;
      auto& side = tree.sides[at(own_row.sides[s])];
      if (p.halves && p.side_centre[s] >= 0) visit(side.centre);
      visit(side.first_child);
    }
  }
  PLIANT_HOST_DEVICE void place(Index r, Index node, int point) const {
    made[node - first_node] = {node, leaf(r), cell(r).has, pattern_at(r).place[at(point)]};
  }
  static PLIANT_HOST_DEVICE Index first_inner_edge(LeafParts const& own,
                                                   RefinementPattern const& p) {
    return own.edge + own.edges - p.inner_edges;
  }
  static PLIANT_HOST_DEVICE std::int16_t level_of_children(TreeCell const& parent,
                                                           RefinementPattern const& p) {
    return static_cast<std::int16_t>(parent.level + (p.halves ? 1 : 0));
  }
  /// The node at a point of a leaf's pattern.
  [[nodiscard]] PLIANT_HOST_DEVICE Index point(Index c, RefinementPattern const& p, int i) const {
    auto const own_row = tree.row(c);
    if (i < p.corners) return own_row.nodes[at(i)];
    if (i == p.centre) return tree.cells[at(c)].centre;
    if (i < p.corners + p.edges) return tree.edges[at(own_row.edges[at(i - p.corners)])].middle;
    std::size_t s = 0;
    while (p.side_centre[s] != i) ++s;
    return tree.sides[at(own_row.sides[s])].centre;
  }
  /// The edge of a child between two points.
  [[nodiscard]] PLIANT_HOST_DEVICE Index edge_of_child(CellRow const& parent,
                                                       RefinementPattern const& p, int a, int b,
                                                       RefinementPattern::Part part,
                                                       Index first_inner_edge) const {
    if (part.home == RefinementPattern::Home::inside) return first_inner_edge + part.number;
    if (part.home == RefinementPattern::Home::side) {
      Index const side = parent.sides[at(part.number)];
      if (!p.halves) return tree.sides[at(side)].first_inner_edge;
      auto const edge_at = [&](int point) {
        return point < p.corners + p.edges ? parent.edges[at(point - p.corners)] : -1;
      };
      return edge_at(a) >= 0 ? inner_edge_of_side(tree, side, edge_at(a), edge_at(b))
                             : inner_edge_of_side(tree, side, edge_at(b), -1);
    }
    Index const whole = parent.edges[at(part.number)];
    if (!p.halves) return whole;
    return half_at(tree, whole, parent.nodes[at(a < p.corners ? a : b)]);
  }
  /// The side of a child that lies on one of the parent's, where the child's own edges have these numbers.
  [[nodiscard]] PLIANT_HOST_DEVICE Index side_of_child(CellRow const& parent,
                                                       RefinementPattern const& p,
                                                       RefinementPattern::Part part,
                                                       CellNumbers const& child,
                                                       std::array<int, 4> const& edges) const {
    auto const there = at(part.number);
    Index const whole = parent.sides[there];
    if (!is_divided(p, there)) return whole;
    if (!p.halves)
      return half_of_side(
          tree, whole,
          {child.edges[at(edges[0])], child.edges[at(edges[1])], child.edges[at(edges[2])]});
    if (part.corner < 0) return tree.sides[at(whole)].first_child + 3;
    auto const& around = p.edges_of_side[there];
    int const k = part.corner, last = k > 0 ? k - 1 : p.corners_of_side(part.number) - 1;
    return quarter_of_side(tree, whole, parent.edges[at(around[at(k)])],
                           parent.edges[at(around[at(last)])]);
  }
};

}  // namespace pliant::detail
