#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <pliant/config.hpp>
#include <pliant/topology/shape_weights.hpp>
#include <pliant/topology/tree_view.hpp>

// Where nodes of a tree hang, and on what, as loops of a backend see it. See HangingNodes for the rule.
namespace pliant::detail {

/// Nodes with weights, each once, in memory of its own.
struct MasterList {
  static constexpr int most = 64;
  Index nodes[most];
  double weights[most];
  int count = 0;
  bool fits = true;

  PLIANT_HOST_DEVICE void add(Index node, double weight) {
    for (int k = 0; k < count; ++k)
      if (nodes[k] == node) {
        weights[k] += weight;
        return;
      }
    if (count == most) {
      fits = false;
      return;
    }
    nodes[count] = node;
    weights[count++] = weight;
  }
  PLIANT_HOST_DEVICE void remove(int k) {
    --count;
    nodes[k] = nodes[count];
    weights[k] = weights[count];
  }
  PLIANT_HOST_DEVICE void sort() {
    for (int i = 1; i < count; ++i)
      for (int k = i; k > 0 && nodes[k - 1] > nodes[k]; --k) {
        Index const node = nodes[k];
        double const weight = weights[k];
        nodes[k] = nodes[k - 1];
        weights[k] = weights[k - 1];
        nodes[k - 1] = node;
        weights[k - 1] = weight;
      }
  }
};

/// The nodes of a tree that hang on its edges and sides.
template <int Dim>
struct HangingView {
  TreeView tree;
  std::uint8_t const* linear =
      nullptr;  // by edge: whether the displacement is linear there (see hanging_degrees.hpp); null: leaves are of one degree

  /// Whether an edge is a leaf's and bisected for others, and lies on no such edge itself.
  [[nodiscard]] PLIANT_HOST_DEVICE bool is_hung_on_edge(Index e) const {
    auto const& own = edge(e);
    if (own.cells.leaves() == 0 || own.first_half < 0) return false;
    for (Index above = own.parent(); above >= 0; above = edge(above).parent())
      if (edge(above).cells.leaves() > 0) return false;
    return true;
  }
  /// Whether a side is a leaf's on one side, and divided on the other.
  [[nodiscard]] PLIANT_HOST_DEVICE bool is_hung_on_side(Index s) const {
    auto const& own = side(s);
    return own.first_child >= 0 && own.cells[0] >= 0 && own.cells[1] >= 0 &&
           tree.is_leaf(own.cells[0]) != tree.is_leaf(own.cells[1]);
  }

  /// Whether the displacement on a whole edge of a leaf is linear.
  [[nodiscard]] PLIANT_HOST_DEVICE bool is_linear(Index e) const {
    return linear != nullptr ? linear[e] != 0 : edge(e).is_linear();
  }

  /// visit(node, i) for the nodes that hang on such an edge: those on it that the leaf has not, or that are of too high a degree.
  template <class Visit>
  PLIANT_HOST_DEVICE void visit_edge(Index e, Visit const& visit) const {
    auto const& own = edge(e);
    if (is_linear(e)) {
      if (own.middle >= 0) visit(own.middle, 2);
      if (linear == nullptr || own.first_half < 0) return;
    }
    for (int half = 0; half < 2; ++half)
      if (Index const node = edge(own.first_half + half).middle; node >= 0) visit(node, half);
  }
  PLIANT_HOST_DEVICE void add_masters_on_edge(Index e, int i, double weight,
                                              MasterList& list) const {
    auto const& own = edge(e);
    double const t = i == 2 ? 0.5 : i == 0 ? 0.25 : 0.75;
    if (is_linear(e)) {
      list.add(own.nodes[0], weight * (1 - t));
      list.add(own.nodes[1], weight * t);
      return;
    }
    list.add(own.nodes[0], weight * ((1 - t) * (1 - 2 * t)));
    list.add(own.middle, weight * (4 * t * (1 - t)));
    list.add(own.nodes[1], weight * (t * (2 * t - 1)));
  }

  /// The same for a side, but for what is on its edges.
  template <class Visit>
  PLIANT_HOST_DEVICE void visit_side(Index s, Visit const& visit) const {
    auto const& own = side(s);
    auto const has = nodes_on(own);
    int const n = static_cast<int>(own.corners());
    if (n == 4 && has != CellNodes::all && own.centre >= 0) visit(own.centre, 0);
    if ((has == CellNodes::corners && linear == nullptr) || own.first_child < 0) return;
    for (int k = 0; k < n; ++k) {
      if (Index const node = edge(own.first_inner_edge + k).middle; node >= 0) visit(node, 1 + k);
      if (n < 4) continue;
      if (Index const node = side(own.first_child + k).centre; node >= 0) visit(node, 5 + k);
    }
  }
  PLIANT_HOST_DEVICE void add_masters_on_side(Index s, int i, double weight,
                                              MasterList& list) const {
    auto const& own = side(s);
    auto const has = nodes_on(own);
    auto const& p = own.pattern();
    auto const n = own.corners();
    bool const quad = n == 4;
    CellNodeList nodes;
    for (std::size_t k = 0; k < n; ++k) nodes.push_back(tree.corner_of(own, k));
    if (has != CellNodes::corners)
      for (std::size_t k = 0; k < n; ++k) nodes.push_back(edge(own.edges[k]).middle);
    if (has == CellNodes::all && quad) nodes.push_back(own.centre);
    auto const k = static_cast<std::size_t>((i - 1) % 4);  // of i > 0
    auto const& centre = p.place[at(quad ? p.centre : 0)];
    auto const& from = i == 0 ? centre : i < 5 ? p.place[n + k] : p.place[k];
    auto const& to = quad ? centre : p.place[n + (k + n - 1) % n];
    std::array<double, 3> place{centre[0], centre[1], 0.0};
    if (i > 0) place = {(from[0] + to[0]) / 2, (from[1] + to[1]) / 2, 0.0};
    add(shape_weights<Dim>(quad ? CellKind::quadrilateral : CellKind::triangle, has, nodes, place),
        weight, list);
  }

  /// Of the node in the middle of a cell.
  PLIANT_HOST_DEVICE void add_masters_in_cell(Index c, double weight, MasterList& list) const {
    auto const& own = tree.cells[at(c)];
    auto const& p = own.pattern();
    add(shape_weights<Dim>(own.kind, own.has, tree.nodes_of(c), p.place[at(p.centre)]), weight,
        list);
  }

  /// The fewest that leaves at a side have: corners only, where an edge between its parts is linear.
  [[nodiscard]] PLIANT_HOST_DEVICE CellNodes nodes_on(TreeSide const& own) const {
    auto has = CellNodes::all;
    auto const meet = [&](Index c) {
      if (c >= 0 && tree.cells[at(c)].has < has) has = tree.cells[at(c)].has;
    };
    if (own.first_child < 0) {
      for (Index const c : own.cells) meet(c);
      return has;
    }
    meet(own.cells[tree.is_leaf(own.cells[0]) ? 0 : 1]);
    for (Index part = own.first_child; part < own.first_child + 4; ++part)
      meet(side(part).any_cell());
    for (Index k = 0; linear != nullptr && k < static_cast<Index>(own.corners()); ++k)
      if (linear[own.first_inner_edge + k] != 0) has = CellNodes::corners;
    return has;
  }

 private:
  static PLIANT_HOST_DEVICE std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static PLIANT_HOST_DEVICE void add(ShapeWeights const& weights, double factor, MasterList& list) {
    for (std::size_t w = 0; w < weights.size(); ++w)
      list.add(weights[w].first, factor * weights[w].second);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE TreeEdge const& edge(Index e) const { return tree.edges[at(e)]; }
  [[nodiscard]] PLIANT_HOST_DEVICE TreeSide const& side(Index s) const { return tree.sides[at(s)]; }
};

}  // namespace pliant::detail
