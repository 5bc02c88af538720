#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/error.hpp>
#include <pliant/topology/each_once.hpp>
#include <pliant/topology/number_table.hpp>
#include <pliant/topology/shared_list.hpp>
#include <pliant/topology/tree_cell.hpp>

namespace pliant {

/// The cells, edges and sides of a mesh under refinement, without geometry: the topology of Hierarchy. Numbers ascend
/// from older to newer. Copies share what neither changes.
template <int Dim>
class CellTree {
 public:
  CellTree() = default;
  explicit CellTree(Index nodes) : nodes_(nodes) {}

  /// Adds a cell of the initial mesh, whose nodes stand in the order of an element (see Element): corners,
  /// then one per edge, one per side with four corners, one in the middle, as far as it has them. Throws
  /// Error where more than two cells share a side, or two lie on the same side of an edge in the plane.
  template <std::size_t N>
  void add(CellKind kind, CellNodes has, std::array<Index, N> const& nodes) {
    TreeCell cell{.kind = kind, .has = has, .had = has};
    auto const& p = pattern_of(kind);
    std::size_t next = static_cast<std::size_t>(p.corners);
    std::copy_n(nodes.begin(), next, cell.nodes.begin());
    auto const c = static_cast<Index>(cells_.size());
    for (std::size_t e = 0; e < at(p.edges); ++e) {
      std::array const ends{cell.nodes[at(p.edge[e][0])], cell.nodes[at(p.edge[e][1])]};
      auto const [edge, is_new] =
          initial_edges_.find_or_add({std::min(ends[0], ends[1]), std::max(ends[0], ends[1])});
      if (is_new) edges_.push_back({.nodes = ends});
      auto const& known = edges_[at(edge)];
      // Counter-clockwise neighbours run along their common edge in opposite directions.
      if (Dim == 2 && !is_new && (known.leaves > 1 || known.nodes == ends))
        throw Error("Hierarchy: cell ", c, " overlaps another one at the edge from node ", ends[0],
                    " to ", ends[1], "; give each edge one cell on either side at most");
      cell.edges[e] = edge;
      if (has != CellNodes::corners) edges_.edit(at(edge)).middle = nodes[next++];
    }
    for (std::size_t s = 0; s < at(p.sides); ++s) {
      auto const side = side_of(cell, s);
      auto key = side.nodes;
      std::ranges::sort(key);
      auto const [number, is_new] = initial_sides_.find_or_add(key);
      if (is_new) sides_.push_back(side);
      auto& known = sides_.edit(at(number));
      if (known.cells[1] >= 0)
        throw Error("Hierarchy: cell ", c, " shares the side at the nodes ", side.nodes[0], ", ",
                    side.nodes[1], " and ", side.nodes[2],
                    " with two others; give each side two cells at most");
      cell.sides[s] = number;
      if (has == CellNodes::all && side.corners() == 4) known.centre = nodes[next++];
    }
    if (has == CellNodes::all && p.centre >= 0) cell.centre = nodes[next++];
    cells_.push_back(cell);
    attach(c);
  }
  /// Ends the initial mesh: what only `add` needs is given up.
  void seal() {
    initial_edges_.clear();
    initial_sides_.clear();
    initial_ = {size(cells_), size(edges_), size(sides_), nodes_};
  }

  [[nodiscard]] SharedList<TreeCell> const& cells() const { return cells_; }
  [[nodiscard]] SharedList<TreeEdge> const& edges() const { return edges_; }
  [[nodiscard]] SharedList<TreeSide> const& sides() const { return sides_; }
  /// The cells that are divided, each once.
  [[nodiscard]] std::vector<Index> const& divided() const { return divided_; }
  [[nodiscard]] TreeCell const& operator[](Index c) const { return cells_[at(c)]; }
  [[nodiscard]] bool is_leaf(Index c) const { return cells_[at(c)].first_child < 0; }
  [[nodiscard]] Index node_count() const { return nodes_; }
  /// Whether leaves with corners only are beside others, or cells of the initial mesh have not the nodes that they
  /// had there.
  [[nodiscard]] bool mixes_degrees() const {
    return (linear_leaves_ > 0 && quadratic_leaves_ > 0) || !converted_.empty();
  }

  /// The edges of cells, each once, ascending.
  [[nodiscard]] std::vector<Index> edges_of(std::vector<Index> const& cells) const {
    std::vector<Index> list;
    for (Index const c : cells)
      std::copy_n(cells_[at(c)].edges.begin(), cells_[at(c)].pattern().edges,
                  std::back_inserter(list));
    return detail::each_once(std::move(list), edges_.size());
  }
  /// The sides of solid cells, each once, ascending.
  [[nodiscard]] std::vector<Index> sides_of(std::vector<Index> const& cells) const {
    std::vector<Index> list;
    for (Index const c : cells)
      std::copy_n(cells_[at(c)].sides.begin(), cells_[at(c)].pattern().sides,
                  std::back_inserter(list));
    return detail::each_once(std::move(list), sides_.size());
  }

  /// Divides a leaf, to be refined one that has no coarser neighbour, and appends the nodes that it makes: the points of
  /// the pattern in their order, then those of the children's elements.
  void divide(Index c, Division division, std::vector<PlacedNode>& made) {
    detach(c);
    cells_.edit(at(c)).division = division;
    TreeCell const parent = cells_[at(c)];
    auto const& p = parent.divided();
    std::array<Index, RefinementPattern::most_points> point{};
    auto const make_node = [&](Index& node, std::array<double, 3> const& place) {
      if (node >= 0) return;
      node = nodes_++;
      made.push_back({node, c, parent.has, place});
    };
    std::copy_n(parent.nodes.begin(), at(p.corners), point.begin());
    for (std::size_t e = 0; p.halves && e < at(p.edges); ++e) {
      auto const k = at(p.corners) + e;
      make_node(edges_.edit(at(parent.edges[e])).middle, p.place[k]);
      bisect(parent.edges[e]);
      point[k] = edges_[at(parent.edges[e])].middle;
    }
    for (std::size_t s = 0; p.halves && s < at(p.sides); ++s) {
      if (p.side_centre[s] >= 0) {
        auto& centre = sides_.edit(at(parent.sides[s])).centre;
        make_node(centre, p.place[at(p.side_centre[s])]);
        point[at(p.side_centre[s])] = centre;
      }
      divide_side(parent.sides[s]);
    }
    if (p.halved_side >= 0) halve_side(parent.sides[at(p.halved_side)], point[at(p.child[0][0])]);
    if (p.centre >= 0) {
      make_node(cells_.edit(at(c)).centre, p.place[at(p.centre)]);
      point[at(p.centre)] = cells_[at(c)].centre;
    }
    int const level = parent.level + (p.halves ? 1 : 0);
    auto const first_inner_edge = static_cast<Index>(edges_.size());
    for (std::size_t i = 0; i < at(p.inner_edges); ++i)
      edges_.push_back({.nodes = {point[at(p.inner_edge[i][0])], point[at(p.inner_edge[i][1])]},
                        .level = level});
    std::array<Index, RefinementPattern::most_inner_sides> inner_side;
    inner_side.fill(-1);

    auto const first_child = static_cast<Index>(cells_.size());
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
          child.sides[s] =
              p.halves || number == p.halved_side ? part_of_side(whole, side_of(child, s)) : whole;
          continue;
        }
        if (inner_side[at(number)] < 0) {
          inner_side[at(number)] = static_cast<Index>(sides_.size());
          sides_.push_back(side_of(child, s));
        }
        child.sides[s] = inner_side[at(number)];
      }
      cells_.push_back(child);
    }
    cells_.edit(at(c)).first_child = first_child;
    divided_.push_back(c);
    attach(c);
    for (Index child = first_child; child < first_child + p.children; ++child) {
      attach(child);
      if (parent.has != CellNodes::corners) place_nodes(child, c, make_node);
    }
  }

  /// Whether the children of a divided cell are leaves of one degree, of a split one with corners only, that no neighbour
  /// keeps from being merged.
  [[nodiscard]] bool can_be_merged(Index c) const {
    auto const& cell = cells_[at(c)];
    if (cell.first_child < 0) return false;
    auto const has = cell.is_split() ? CellNodes::corners : cells_[at(cell.first_child)].has;
    for (Index i = cell.first_child; i < cell.first_child + cell.divided().children; ++i) {
      auto const& child = cells_[at(i)];
      if (child.first_child >= 0 || child.has != has) return false;
      for (std::size_t e = 0; !cell.is_split() && e < at(child.pattern().edges); ++e)
        if (edges_[at(child.edges[e])].refined > 0) return false;
    }
    return true;
  }

  /// Gives leaves with corners only more nodes, and appends those that it makes.
  void raise(std::vector<CellConversion> const& conversions, std::vector<PlacedNode>& made) {
    for (auto const& to : conversions) {
      convert(to);
      auto const& p = cells_[at(to.cell)].pattern();
      auto const make_node = [&](Index& node, std::array<double, 3> const& place) {
        if (node >= 0) return;
        node = nodes_++;
        made.push_back({node, to.cell, CellNodes::corners, place});
      };
      auto& cell = cells_.edit(at(to.cell));
      for (std::size_t e = 0; e < at(p.edges); ++e)
        make_node(edges_.edit(at(cell.edges[e])).middle, p.place[at(p.corners) + e]);
      if (to.has != CellNodes::all) continue;
      for (std::size_t s = 0; s < at(p.sides); ++s)
        if (p.side_centre[s] >= 0)
          make_node(sides_.edit(at(cell.sides[s])).centre, p.place[at(p.side_centre[s])]);
      if (p.centre >= 0) make_node(cell.centre, p.place[at(p.centre)]);
    }
    forget_old_conversions();
  }

  /// Gives divided cells, each of which can be merged, the degree of their children.
  void take_degree_of_children(std::vector<Index> const& parents) {
    for (Index const c : parents) {
      auto const has = cells_[at(cells_[at(c)].first_child)].has;
      if (cells_[at(c)].has != has) cells_.edit(at(c)).has = has;
      note_conversion(c);
    }
    forget_old_conversions();
  }

  /// Makes divided cells, each of which can be merged and has the degree of its children, leaves again, and takes leaves
  /// the nodes between their corners. Nodes, cells, edges and sides that nothing uses any more go, but for those
  /// of the initial mesh; the others move up.
  Renumbering merge(std::vector<Index> const& parents, std::vector<Index> const& lowered = {}) {
    std::vector<bool> gone(cells_.size(), false);
    for (Index const c : parents) {
      auto& cell = cells_.edit(at(c));
      Index const first = cell.first_child;
      for (Index child = first; child < first + cell.divided().children; ++child) {
        detach(child);
        gone[at(child)] = true;
      }
      detach(c);
      cell.first_child = -1;
      cell.division = Division::refined;
      attach(c);
    }
    auto touched = parents;
    for (Index const c : lowered) {
      convert({c, CellNodes::corners});
      touched.push_back(c);
    }
    std::erase_if(divided_, [&](Index c) { return is_leaf(c); });
    auto renumbered = compact(touched, std::move(gone));
    forget_old_conversions();
    return renumbered;
  }

  /// The nodes of the element on a cell, in the order of an element's whose corners are cell.nodes.
  [[nodiscard]] CellNodeList nodes_of(Index c) const {
    auto const& cell = cells_[at(c)];
    auto const& p = cell.pattern();
    CellNodeList list;
    for (std::size_t a = 0; a < at(p.corners); ++a) list.push_back(cell.nodes[a]);
    if (cell.has == CellNodes::corners) return list;
    for (std::size_t e = 0; e < at(p.edges); ++e) list.push_back(edges_[at(cell.edges[e])].middle);
    if (cell.has != CellNodes::all) return list;
    for (std::size_t s = 0; s < at(p.sides); ++s)
      if (p.side_centre[s] >= 0) list.push_back(sides_[at(cell.sides[s])].centre);
    if (p.centre >= 0) list.push_back(cell.centre);
    return list;
  }
  /// The same as the element has them, whose volume is positive.
  [[nodiscard]] CellNodeList element_nodes(Index c) const {
    auto list = nodes_of(c);
    if (!cells_[at(c)].mirrored) return list;
    std::swap(list.nodes[2], list.nodes[3]);
    if (list.count == 10) {  // edges 0-1, 1-2, 2-0, 0-3, 1-3, 2-3
      std::swap(list.nodes[5], list.nodes[8]);
      std::swap(list.nodes[6], list.nodes[7]);
    }
    return list;
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("cells", r.cells_...);
    visit("edges", r.edges_...);
    visit("sides", r.sides_...);
    visit("divided cells", r.divided_...);
    visit("cells of other degrees", r.converted_...);
    visit("leaves with corners only", r.linear_leaves_...);
    visit("other leaves", r.quadratic_leaves_...);
    visit("initial mesh", r.initial_...);
    visit("number of nodes", r.nodes_...);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static Index size(auto const& list) { return static_cast<Index>(list.size()); }

  /// Side s of a cell, as the cell sees it.
  static TreeSide side_of(TreeCell const& cell, std::size_t s) {
    auto const& p = cell.pattern();
    TreeSide side{.level = cell.level};
    for (std::size_t k = 0; k < at(p.corners_of_side(static_cast<int>(s))); ++k) {
      side.nodes[k] = cell.nodes[at(p.side[s][k])];
      side.edges[k] = cell.edges[at(p.edges_of_side[s][k])];
    }
    return side;
  }

  void convert(CellConversion const& to) {
    detach(to.cell);
    cells_.edit(at(to.cell)).has = to.has;
    attach(to.cell);
    note_conversion(to.cell);
  }
  void note_conversion(Index c) {
    if (c < initial_.cells && cells_[at(c)].has != cells_[at(c)].had) converted_.push_back(c);
  }
  void forget_old_conversions() {
    converted_ = detail::each_once(std::move(converted_));
    std::erase_if(converted_, [&](Index c) { return cells_[at(c)].has == cells_[at(c)].had; });
  }

  void attach(Index c) { count_uses(c, 1); }
  void detach(Index c) { count_uses(c, -1); }
  void count_uses(Index c, int by) {
    auto const& cell = cells_[at(c)];
    if (cell.is_split()) {  // its children have its edges and sides, but for one that is divided
      if (int const s = cell.divided().halved_side; s >= 0) count_use(cell.sides[at(s)], c, by);
      return;
    }
    auto const& p = cell.pattern();
    for (std::size_t e = 0; e < at(p.edges); ++e) {
      auto& edge = edges_.edit(at(cell.edges[e]));
      (cell.first_child < 0 ? edge.leaves : edge.refined) += by;
      if (cell.first_child < 0 && cell.has == CellNodes::corners) edge.linear += by;
    }
    if (cell.first_child < 0)
      (cell.has == CellNodes::corners ? linear_leaves_ : quadratic_leaves_) += by;
    for (std::size_t s = 0; s < at(p.sides); ++s) count_use(cell.sides[s], c, by);
  }
  void count_use(Index side, Index c, int by) {
    auto& cells = sides_.edit(at(side)).cells;
    if (by > 0) {
      cells[cells[0] < 0 ? 0 : 1] = c;
    } else {
      if (cells[0] == c) cells[0] = cells[1];
      cells[1] = -1;
    }
  }

  void bisect(Index e) {
    auto const edge = edges_[at(e)];
    if (edge.first_half >= 0) return;
    edges_.edit(at(e)).first_half = static_cast<Index>(edges_.size());
    TreeEdge half{.parent = e, .level = edge.level + 1};
    half.nodes = {edge.nodes[0], edge.middle};
    edges_.push_back(half);
    half.nodes = {edge.middle, edge.nodes[1]};
    edges_.push_back(half);
  }
  /// The half of a bisected edge that touches its end `node`.
  [[nodiscard]] Index half_at(Index e, Index node) const {
    auto const& edge = edges_[at(e)];
    return edge.nodes[0] == node ? edge.first_half : edge.first_half + 1;
  }

  /// Divides a side whose edges are bisected, and which has its centre, in four.
  void divide_side(Index s) {
    auto const side = sides_[at(s)];
    if (side.first_child >= 0) return;
    auto const n = side.corners();
    bool const quad = n == 4;
    auto const inner = static_cast<Index>(edges_.size());
    sides_.edit(at(s)).first_child = static_cast<Index>(sides_.size());
    sides_.edit(at(s)).first_inner_edge = inner;
    std::array<Index, 4> middle{};
    for (std::size_t k = 0; k < n; ++k) middle[k] = edges_[at(side.edges[k])].middle;
    // Inner edge k joins the middle of edge k to the centre, or round corner k of a triangle.
    for (std::size_t k = 0; k < n; ++k)
      edges_.push_back({.nodes = {middle[k], quad ? side.centre : middle[(k + n - 1) % n]},
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
      sides_.push_back(child);
    }
    if (quad) return;
    child.nodes = {middle[1], middle[2], middle[0], -1};
    child.edges = {inner + 2, inner, inner + 1, -1};
    sides_.push_back(child);
  }

  /// Divides a side with four corners in two triangles, along the diagonal from one of them.
  void halve_side(Index s, Index corner) {
    auto const side = sides_[at(s)];
    if (side.first_child >= 0) return;
    std::size_t const k = side.nodes[0] == corner || side.nodes[2] == corner ? 0 : 1;
    auto const diagonal = static_cast<Index>(edges_.size());
    edges_.push_back({.nodes = {side.nodes[k], side.nodes[k + 2]}, .level = side.level});
    sides_.edit(at(s)).first_child = static_cast<Index>(sides_.size());
    sides_.edit(at(s)).first_inner_edge = diagonal;
    for (std::size_t a = k; a < k + 3; a += 2)
      sides_.push_back(
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
      auto const& ends = edges_[at(whole)].nodes;
      return half_at(whole, a == ends[0] || a == ends[1] ? a : b);
    }
    auto const& side = sides_[at(parent.sides[at(part.number)])];
    Index inner = side.first_inner_edge;
    auto const joins = [&](std::array<Index, 2> const& ends) {
      return (ends[0] == a && ends[1] == b) || (ends[0] == b && ends[1] == a);
    };
    while (!joins(edges_[at(inner)].nodes)) ++inner;
    return inner;
  }
  /// The part of a divided side that has the corners of another.
  [[nodiscard]] Index part_of_side(Index s, TreeSide const& wanted) const {
    Index part = sides_[at(s)].first_child;
    auto const has_all = [&](std::array<Index, 4> const& nodes) {
      return std::ranges::all_of(
          wanted.nodes, [&](Index node) { return std::ranges::find(nodes, node) != nodes.end(); });
    };
    while (!has_all(sides_[at(part)].nodes)) ++part;
    return part;
  }

  /// Gives the element on a new child the nodes between its corners.
  template <class MakeNode>
  void place_nodes(Index child, Index parent, MakeNode const& make_node) {
    auto& cell = cells_.edit(at(child));
    auto const& p = cell.pattern();
    auto const& divided = cells_[at(parent)].divided();
    auto const& corner = divided.child[at(child - cells_[at(parent)].first_child)];
    auto const mean = [&](auto const& corners, std::size_t count) {
      std::array<double, 3> sum{};
      for (std::size_t k = 0; k < count; ++k)
        for (std::size_t d = 0; d < 3; ++d)
          sum[d] += divided.place[at(corner[at(corners[k])])][d] / static_cast<double>(count);
      return sum;
    };
    for (std::size_t e = 0; e < at(p.edges); ++e)
      make_node(edges_.edit(at(cell.edges[e])).middle, mean(p.edge[e], 2));
    if (cell.has != CellNodes::all) return;
    for (std::size_t s = 0; s < at(p.sides); ++s)
      if (p.side_centre[s] >= 0)
        make_node(sides_.edit(at(cell.sides[s])).centre, mean(p.side[s], 4));
    if (p.centre < 0) return;
    std::array<int, 8> const corners{0, 1, 2, 3, 4, 5, 6, 7};
    make_node(cell.centre, mean(corners, at(p.corners)));
  }

  [[nodiscard]] std::vector<Index> initial_of(std::vector<Index> cells) const {
    std::erase_if(cells, [&](Index c) { return c >= initial_.cells; });
    return cells;
  }

  /// Takes away what nothing uses any more after `touched` became leaves and their children went, or lost their nodes. What
  /// the initial mesh has stays, and of it only what refined and converted cells have knows of the rest.
  Renumbering compact(std::vector<Index> const& touched, std::vector<bool> cell_gone) {
    auto const& i = initial_;
    std::vector<bool> node_used(at(nodes_), false), edge_used(edges_.size(), true),
        side_used(sides_.size(), true);
    std::fill_n(node_used.begin(), i.nodes, true);
    for (Index c = i.cells; c < size(cells_); ++c)
      if (!cell_gone[at(c)])
        for (Index const node : nodes_of(c)) node_used[at(node)] = true;
    for (Index const c : converted_)
      for (Index const node : nodes_of(c)) node_used[at(node)] = true;

    auto const forget = [&](Index& node) {
      if (node >= 0 && !node_used[at(node)]) node = -1;
    };
    auto const mend_edge = [&](Index e) {
      auto& edge = edges_.edit(at(e));
      if (edge.refined == 0) edge.first_half = -1;
      forget(edge.middle);
    };
    auto const mend_side = [&](Index s) {
      auto& side = sides_.edit(at(s));
      if (std::ranges::none_of(side.cells, [&](Index c) { return c >= 0 && !is_leaf(c); }))
        side.first_child = side.first_inner_edge = -1;
      forget(side.centre);
    };
    for (Index const e : edges_of(initial_of(touched))) mend_edge(e);
    for (Index const s : sides_of(initial_of(touched))) mend_side(s);
    for (Index const c : touched) forget(cells_.edit(at(c)).centre);
    for (Index e = i.edges; e < size(edges_); ++e) {
      edge_used[at(e)] = edges_[at(e)].leaves + edges_[at(e)].refined > 0;
      mend_edge(e);
    }
    for (Index s = i.sides; s < size(sides_); ++s) {
      side_used[at(s)] = sides_[at(s)].cells[0] >= 0;
      mend_side(s);
    }

    cell_gone.flip();
    auto const node = numbers(node_used, i.nodes), cell = numbers(cell_gone, i.cells),
               edge = numbers(edge_used, i.edges), side = numbers(side_used, i.sides);
    keep(cells_, cell_gone, i.cells);
    keep(edges_, edge_used, i.edges);
    keep(sides_, side_used, i.sides);
    auto const move = [](Index& number, std::vector<Index> const& to) {
      if (number >= 0) number = to[at(number)];
    };
    for (Index& c : divided_) move(c, cell);
    auto const move_within_cell = [&](TreeCell& c) {
      move(c.first_child, cell);
      move(c.centre, node);
    };
    auto const move_within_edge = [&](TreeEdge& e) {
      move(e.middle, node);
      move(e.first_half, edge);
    };
    auto const move_within_side = [&](TreeSide& s) {
      move(s.centre, node);
      move(s.first_child, side);
      move(s.first_inner_edge, edge);
      for (Index& c : s.cells) move(c, cell);  // parts of split cells among them
    };
    auto knowing = initial_of(divided_);
    knowing.insert(knowing.end(), converted_.begin(), converted_.end());
    knowing = detail::each_once(std::move(knowing));
    for (Index const c : knowing) move_within_cell(cells_.edit(at(c)));
    for (Index const e : edges_of(knowing)) move_within_edge(edges_.edit(at(e)));
    for (Index const s : sides_of(knowing)) move_within_side(sides_.edit(at(s)));
    for (Index n = i.cells; n < size(cells_); ++n) {
      auto& c = cells_.edit(at(n));
      move_within_cell(c);
      move(c.parent, cell);
      for (Index& p : c.nodes) move(p, node);
      for (Index& e : c.edges) move(e, edge);
      for (Index& s : c.sides) move(s, side);
    }
    for (Index n = i.edges; n < size(edges_); ++n) {
      auto& e = edges_.edit(at(n));
      move_within_edge(e);
      move(e.parent, edge);
      move(e.side, side);
      for (Index& p : e.nodes) move(p, node);
    }
    for (Index n = i.sides; n < size(sides_); ++n) {
      auto& s = sides_.edit(at(n));
      move_within_side(s);
      move(s.parent, side);
      for (Index& p : s.nodes) move(p, node);
      for (Index& e : s.edges) move(e, edge);
    }
    nodes_ = static_cast<Index>(std::ranges::count(node_used, true));
    return {node, cell};
  }
  /// All before `first` are.
  static std::vector<Index> numbers(std::vector<bool> const& used, Index first) {
    std::vector<Index> list(used.size());
    std::iota(list.begin(), list.begin() + first, Index{0});
    Index next = first;
    for (std::size_t k = at(first); k < used.size(); ++k) list[k] = used[k] ? next++ : -1;
    return list;
  }
  /// Moves up what is used; all before `first` is.
  template <class V>
  static void keep(SharedList<V>& list, std::vector<bool> const& used, Index first) {
    std::size_t next = at(first);
    for (std::size_t k = next; k < list.size(); ++k)
      if (used[k]) {
        if (next != k) list.edit(next) = list[k];
        ++next;
      }
    list.shrink(next);
  }

  SharedList<TreeCell> cells_;
  SharedList<TreeEdge> edges_;
  SharedList<TreeSide> sides_;
  std::vector<Index> divided_;
  std::vector<Index> converted_;  // of the initial mesh, that have not what they had: each once
  Index linear_leaves_ = 0, quadratic_leaves_ = 0;
  Index nodes_ = 0;
  TreeSizes initial_;
  NumberTable<2> initial_edges_;  // by their corners, ascending
  NumberTable<4> initial_sides_;
};

}  // namespace pliant
