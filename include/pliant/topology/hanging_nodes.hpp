#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/topology/cell_tree.hpp>
#include <pliant/topology/compose.hpp>
#include <pliant/topology/shape_weights.hpp>

namespace pliant {

/// The nodes of a tree that hang, by the minimum rule: on an edge or side the displacement is of the lowest degree of
/// all leaves around, and on a whole edge or side of a leaf it is what that leaf's nodes say. A side whose leaf
/// meets finer ones of lower degree, or has such an edge between its parts, is of that degree throughout, with its edges.
template <int Dim>
class HangingNodes {
 public:
  explicit HangingNodes(CellTree<Dim> const& tree) : tree_(tree), edges_(tree.edges()) {}

  /// Every one, ascending, with its free masters.
  [[nodiscard]] SlaveRows slaves() {
    if (tree_.mixes_degrees()) {
      listed_.assign(at(tree_.node_count()), false);
      linear_edge_.assign(edges_.size(), false);
    }
    auto const& divided_cells = tree_.divided();
    auto const edges = tree_.edges_of(divided_cells);
    auto divided = sides_have_nodes() ? divided_sides(tree_.sides_of(divided_cells))
                                      : std::vector<DividedSide>{};
    if (mixed()) lower_sides(divided);
    detail::HostParts const parts(static_cast<Index>(edges.size() + divided.size()),
                                  mixed() ? std::numeric_limits<Index>::max() : Index{2048});
    std::vector<Found> found(static_cast<std::size_t>(parts.count()));
    parts([&](Index from, Index to, int part) {
      auto& own = found[static_cast<std::size_t>(part)];
      for (auto k = at(from); k < at(to); ++k)
        if (k >= edges.size())
          add_nodes_on_parts(*divided[k - edges.size()].side, divided[k - edges.size()].has, own);
        else if (edges_[at(edges[k])].cells.leaves() > 0)
          add_nodes_on(edges[k], own);
    });
    if (mixed()) add_nodes_of_higher_degree(found[0]);
    // The masters of a node at an element's side are that element's nodes; those can hang at coarser ones, and those on
    // the side's edges can be of too high a degree there.
    SlaveRows slaves;
    std::size_t levels = 0;
    for (auto const& own : found) levels = std::max(levels, own.size());
    for (std::size_t k = 0; k < levels; ++k)
      for (auto const& own : found)
        if (k < own.size()) slaves.append(own[k]);
    return compose_rows(slaves);
  }

 private:
  using Masters = detail::ShapeWeights;
  /// Hanging nodes by the level of the coarser element, each level's on edges before those on sides.
  using Found = std::vector<SlaveRows>;

  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] bool mixed() const { return !listed_.empty(); }

  /// Whether nodes may hang on sides, beside those on their edges: not where all cells are tetrahedra with corners only.
  [[nodiscard]] bool sides_have_nodes() const {
    auto const& lists = tree_.lists();
    return mixed() || lists.quadratic_leaves > 0 ||
           lists.layout.shift != RowLayout::of_tetrahedra().shift;
  }
  /// Whether the displacement on a whole edge of a leaf is linear.
  [[nodiscard]] bool is_linear(Index e) const {
    auto const& edge = edges_[at(e)];
    if (edge.is_linear() || (mixed() && linear_edge_[at(e)])) return true;
    return edge.first_half >= 0 && (is_linear(edge.first_half) || is_linear(edge.first_half + 1));
  }
  void add(Found& found, int level, bool on_side, Index node, Masters masters) {
    if (mixed()) {
      if (listed_[at(node)]) return;
      listed_[at(node)] = true;
    }
    std::ranges::sort(masters);
    auto const place = 2 * static_cast<std::size_t>(level) + (on_side ? 1 : 0);
    if (found.size() <= place) found.resize(place + 1);
    found[place].push_back(node, masters);
  }

  /// The nodes on a whole edge of a leaf that is bisected for others, unless it lies on such an edge itself.
  void add_nodes_on(Index e, Found& found) {
    auto const& edge = edges_[at(e)];
    for (Index above = edge.parent(); above >= 0; above = edges_[at(above)].parent())
      if (edges_[at(above)].cells.leaves() > 0) return;
    Index const a = edge.nodes[0], b = edge.nodes[1];
    bool const linear = is_linear(e);
    auto const add_between = [&](auto const& self, Index part, double from, double to) -> void {
      auto const& own = edges_[at(part)];
      double const t = (from + to) / 2;
      if (own.middle >= 0 && linear)
        add(found, edge.level, false, own.middle, {{a, 1 - t}, {b, t}});
      else if (own.middle >= 0 && part != e)
        add(found, edge.level, false, own.middle,
            {{a, (1 - t) * (1 - 2 * t)}, {edge.middle, 4 * t * (1 - t)}, {b, t * (2 * t - 1)}});
      if (own.first_half < 0) return;
      self(self, own.first_half, from, t);
      self(self, own.first_half + 1, t, to);
    };
    add_between(add_between, e, 0, 1);
  }

  /// A side that is a leaf's on one side and divided on the other, and the nodes that displacements on it have.
  struct DividedSide {
    TreeSide const* side;
    CellNodes has;
  };
  /// With those of the leaves on either side.
  [[nodiscard]] std::vector<DividedSide> divided_sides(std::vector<Index> const& sides) const {
    std::vector<DividedSide> found;
    for (Index const s : sides) {
      auto const& side = tree_.sides()[at(s)];
      if (side.cells[0] < 0 || side.cells[1] < 0 ||
          tree_.is_leaf(side.cells[0]) == tree_.is_leaf(side.cells[1]))
        continue;
      auto has = tree_[side.cells[tree_.is_leaf(side.cells[0]) ? 0 : 1]].has;
      for (Index part = side.first_child; part < side.first_child + 4; ++part)
        has = std::min(has, tree_[tree_.sides()[at(part)].any_cell()].has);
      found.push_back({&side, has});
    }
    return found;
  }
  /// Makes sides linear that have a linear edge between their parts, and the edges of linear sides; finer ones first, as
  /// their edges may lie between parts of coarser ones.
  void lower_sides(std::vector<DividedSide>& sides) {
    std::ranges::stable_sort(sides, std::ranges::greater{},
                             [](DividedSide const& own) { return own.side->level; });
    for (auto& [side, has] : sides) {
      auto const n = side->corners();
      for (Index k = 0; k < static_cast<Index>(n); ++k)
        if (is_linear(side->first_inner_edge + k)) has = CellNodes::corners;
      for (std::size_t k = 0; has == CellNodes::corners && k < n; ++k)
        linear_edge_[at(side->edges[k])] = true;
    }
  }
  /// The nodes of a side as an element has them.
  [[nodiscard]] CellNodeList nodes_of(TreeSide const& side, CellNodes has) const {
    auto const n = side.corners();
    CellNodeList nodes;
    for (std::size_t k = 0; k < n; ++k) nodes.push_back(tree_.corner_of(side, k));
    if (has == CellNodes::corners) return nodes;
    for (std::size_t k = 0; k < n; ++k) nodes.push_back(edges_[at(side.edges[k])].middle);
    if (has == CellNodes::all && n == 4) nodes.push_back(side.centre);
    return nodes;
  }
  /// The nodes between a leaf's side and its parts on the other side that the leaf itself has not, or that are of a
  /// higher degree than `has`.
  void add_nodes_on_parts(TreeSide const& side, CellNodes has, Found& found) {
    auto const& p = side.pattern();
    auto const n = side.corners();
    bool const quad = n == 4;
    auto const nodes = nodes_of(side, has);
    auto const kind = quad ? CellKind::quadrilateral : CellKind::triangle;
    auto const add_at = [&](Index node, std::array<double, 3> const& place) {
      if (node >= 0)
        add(found, side.level, true, node, detail::shape_weights<Dim>(kind, has, nodes, place));
    };
    if (quad && has != CellNodes::all) add_at(side.centre, p.place[at(p.centre)]);
    if (has == CellNodes::corners && !mixed()) return;
    auto const middle = [](std::array<double, 3> const& a, std::array<double, 3> const& b) {
      return std::array{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, 0.0};
    };
    for (std::size_t k = 0; k < n; ++k) {
      auto const& from = p.place[n + k];
      auto const& to = quad ? p.place[at(p.centre)] : p.place[n + (k + n - 1) % n];
      add_at(edges_[at(side.first_inner_edge) + k].middle, middle(from, to));
      if (quad)
        add_at(tree_.sides()[at(side.first_child) + k].centre,
               middle(p.place[k], p.place[at(p.centre)]));
    }
  }

  /// Nodes between the corners of whole edges and sides, and in the middle of cells, that are there for leaves of a higher
  /// degree than others around, or for none any more.
  void add_nodes_of_higher_degree(Found& found) {
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      auto const& edge = edges_[e];
      if (edge.cells.leaves() > 0 && edge.first_half < 0 && edge.middle >= 0 &&
          is_linear(static_cast<Index>(e)))
        add(found, edge.level, false, edge.middle, {{edge.nodes[0], 0.5}, {edge.nodes[1], 0.5}});
    }
    for (TreeSide const& side : tree_.sides()) {
      if (side.centre < 0 || side.first_child >= 0) continue;
      auto has = CellNodes::all;
      for (Index const c : side.cells)
        if (c >= 0) has = std::min(has, tree_[c].has);
      if (has == CellNodes::all) continue;
      add(found, side.level, true, side.centre,
          detail::shape_weights<Dim>(CellKind::quadrilateral, has, nodes_of(side, has), {0, 0, 0}));
    }
    for (Index c = 0; c < static_cast<Index>(tree_.cells().size()); ++c) {
      auto const& cell = tree_[c];
      if (cell.first_child >= 0 || cell.centre < 0 || cell.has == CellNodes::all) continue;
      auto const& p = cell.pattern();
      add(found, cell.level, true, cell.centre,
          detail::shape_weights<Dim>(cell.kind, cell.has, tree_.nodes_of(c),
                                     p.place[at(p.centre)]));
    }
  }

  CellTree<Dim> const& tree_;
  SharedList<TreeEdge> const& edges_;
  std::vector<bool> listed_;       // by node; empty where leaves are of one degree
  std::vector<bool> linear_edge_;  // by edge, from sides
};

}  // namespace pliant
