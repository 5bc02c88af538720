#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/error.hpp>
#include <pliant/topology/tree_cell.hpp>

namespace pliant {

/// The cells, edges and sides of a mesh under refinement, plane or solid, without geometry: the topology of
/// Hierarchy. Numbers ascend from older to newer.
class CellTree {
 public:
  CellTree() = default;
  explicit CellTree(Index nodes) : nodes_(nodes) {}

  /// Adds a cell of the initial mesh, whose nodes stand in the order of an element (see Element): corners,
  /// then one per edge, one per side with four corners, one in the middle, as far as it has them. Throws
  /// Error where more than two cells share a side, or two lie on the same side of an edge in the plane.
  template <std::size_t N>
  void add(CellKind kind, CellNodes has, std::array<Index, N> const& nodes) {
    TreeCell cell{.kind = kind, .has = has};
    auto const& p = pattern_of(kind);
    std::size_t next = static_cast<std::size_t>(p.corners);
    std::copy_n(nodes.begin(), next, cell.nodes.begin());
    auto const c = static_cast<Index>(cells_.size());
    for (std::size_t e = 0; e < at(p.edges); ++e) {
      std::array const ends{cell.nodes[at(p.edge[e][0])], cell.nodes[at(p.edge[e][1])]};
      auto const [entry, is_new] =
          initial_edges_.try_emplace({std::min(ends[0], ends[1]), std::max(ends[0], ends[1])},
                                     static_cast<Index>(edges_.size()));
      if (is_new) edges_.push_back({.nodes = ends, .has = has});
      auto const& known = edges_[at(entry->second)];
      // Counter-clockwise neighbours run along their common edge in opposite directions.
      if (p.dim == 2 && !is_new && (known.leaves > 1 || known.nodes == ends))
        throw Error("Hierarchy: cell ", c, " overlaps another one at the edge from node ", ends[0],
                    " to ", ends[1], "; give each edge one cell on either side at most");
      cell.edges[e] = entry->second;
      if (has != CellNodes::corners) edges_[at(entry->second)].middle = nodes[next++];
    }
    for (std::size_t s = 0; s < at(p.sides); ++s) {
      auto side = side_of(cell, s);
      auto key = side.nodes;
      std::ranges::sort(key);
      auto const [entry, is_new] =
          initial_sides_.try_emplace(key, static_cast<Index>(sides_.size()));
      if (is_new) sides_.push_back(side);
      auto& known = sides_[at(entry->second)];
      if (known.cells[1] >= 0)
        throw Error("Hierarchy: cell ", c, " shares the side at the nodes ", side.nodes[0], ", ",
                    side.nodes[1], " and ", side.nodes[2],
                    " with two others; give each side two cells at most");
      cell.sides[s] = entry->second;
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
  }

  [[nodiscard]] std::vector<TreeCell> const& cells() const { return cells_; }
  [[nodiscard]] std::vector<TreeEdge> const& edges() const { return edges_; }
  [[nodiscard]] std::vector<TreeSide> const& sides() const { return sides_; }
  [[nodiscard]] TreeCell const& operator[](Index c) const { return cells_[at(c)]; }
  [[nodiscard]] bool is_leaf(Index c) const { return cells_[at(c)].first_child < 0; }
  [[nodiscard]] Index node_count() const { return nodes_; }

  /// The leaves, given each once, and all that must be refined before them so that levels differ by
  /// one at most across edges and sides: coarser ones first, then ascending.
  [[nodiscard]] std::vector<Index> closure(std::vector<Index> leaves) const {
    std::unordered_set<Index> seen(leaves.begin(), leaves.end());
    auto const on_edge = leaves_on_bisected_edges();
    auto const want = [&](Index c) {
      if (c >= 0 && is_leaf(c) && seen.insert(c).second) leaves.push_back(c);
    };
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      auto const cell = cells_[at(leaves[i])];
      for (std::size_t e = 0; e < at(cell.pattern().edges); ++e) {
        Index const coarse = edges_[at(cell.edges[e])].parent;
        if (coarse < 0 || edges_[at(coarse)].leaves == 0) continue;
        auto const first = std::ranges::lower_bound(on_edge, std::pair(coarse, Index{-1}));
        for (auto entry = first; entry != on_edge.end() && entry->first == coarse; ++entry)
          want(entry->second);
      }
      for (std::size_t s = 0; s < at(cell.pattern().sides); ++s) {
        Index const coarse = sides_[at(cell.sides[s])].parent;
        if (coarse < 0) continue;
        for (Index neighbour : sides_[at(coarse)].cells) want(neighbour);
      }
    }
    std::ranges::sort(leaves, {}, [&](Index c) { return std::pair(cells_[at(c)].level, c); });
    return leaves;
  }

  /// How many nodes it takes to split all of these leaves.
  [[nodiscard]] std::size_t count_new_nodes(std::vector<Index> const& leaves) const {
    std::size_t nodes = 0;
    std::unordered_set<Index> edges, sides;
    for (Index const c : leaves) {
      auto const& cell = cells_[at(c)];
      auto const& p = cell.pattern();
      bool const quadratic = cell.has != CellNodes::corners;
      for (std::size_t e = 0; e < at(p.edges); ++e) {
        auto const& edge = edges_[at(cell.edges[e])];
        if (edge.first_half >= 0 || !edges.insert(cell.edges[e]).second) continue;
        nodes += (edge.middle < 0 ? 1 : 0) + (quadratic ? 2 : 0);
      }
      for (std::size_t s = 0; s < at(p.sides); ++s) {
        auto const& side = sides_[at(cell.sides[s])];
        if (side.first_child >= 0 || !sides.insert(cell.sides[s]).second) continue;
        bool const quad = side.corners() == 4;
        nodes += quad && side.centre < 0 ? 1 : 0;
        nodes += quadratic ? side.corners() : 0;
        nodes += quad && cell.has == CellNodes::all ? 4 : 0;
      }
      nodes += p.centre >= 0 && cell.centre < 0 ? 1 : 0;
      nodes += quadratic ? at(p.inner_edges) : 0;
      if (cell.has == CellNodes::all && p.centre >= 0) nodes += at(p.inner_sides + p.children);
    }
    return nodes;
  }

  /// How many cells it takes to split all of these leaves.
  [[nodiscard]] std::size_t count_new_cells(std::vector<Index> const& leaves) const {
    std::size_t cells = 0;
    for (Index const c : leaves) cells += at(cells_[at(c)].pattern().children);
    return cells;
  }

  /// Makes room to split these leaves without allocation, in amortized constant time for each.
  void make_room(std::vector<Index> const& leaves) {
    std::size_t edges = 0, sides = 0;
    for (Index const c : leaves) {
      auto const& p = cells_[at(c)].pattern();
      edges += at(2 * p.edges + 4 * p.sides + p.inner_edges);
      sides += at(4 * p.sides + p.inner_sides);
    }
    reserve(cells_, count_new_cells(leaves));
    reserve(edges_, edges);
    reserve(sides_, sides);
  }
  /// The most edges that splits of these leaves can make.
  [[nodiscard]] std::size_t most_new_edges(std::vector<Index> const& leaves) const {
    std::size_t edges = 0;
    for (Index const c : leaves) {
      auto const& p = cells_[at(c)].pattern();
      edges += at(2 * p.edges + 4 * p.sides + p.inner_edges);
    }
    return edges;
  }

  /// Splits a leaf that has no coarser neighbour, and appends the nodes that it makes: the points of the
  /// pattern in their order, then those of the children's elements.
  void split(Index c, std::vector<PlacedNode>& made) {
    TreeCell const parent = cells_[at(c)];
    auto const& p = parent.pattern();
    detach(c);
    std::array<Index, RefinementPattern::most_points> point{};
    auto const make_node = [&](Index& node, std::array<double, 3> const& place) {
      if (node >= 0) return;
      node = nodes_++;
      made.push_back({node, c, place});
    };
    std::copy_n(parent.nodes.begin(), at(p.corners), point.begin());
    for (std::size_t e = 0; e < at(p.edges); ++e) {
      auto const k = at(p.corners) + e;
      make_node(edges_[at(parent.edges[e])].middle, p.place[k]);
      bisect(parent.edges[e]);
      point[k] = edges_[at(parent.edges[e])].middle;
    }
    for (std::size_t s = 0; s < at(p.sides); ++s) {
      auto& side = sides_[at(parent.sides[s])];
      if (p.side_centre[s] >= 0) {
        make_node(side.centre, p.place[at(p.side_centre[s])]);
        point[at(p.side_centre[s])] = side.centre;
      }
      divide(parent.sides[s]);
    }
    if (p.centre >= 0) {
      make_node(cells_[at(c)].centre, p.place[at(p.centre)]);
      point[at(p.centre)] = cells_[at(c)].centre;
    }
    auto const first_inner_edge = static_cast<Index>(edges_.size());
    for (std::size_t i = 0; i < at(p.inner_edges); ++i)
      edges_.push_back({.nodes = {point[at(p.inner_edge[i][0])], point[at(p.inner_edge[i][1])]},
                        .level = parent.level + 1,
                        .has = parent.has});
    std::array<Index, 12> inner_side;
    inner_side.fill(-1);

    auto const first_child = static_cast<Index>(cells_.size());
    for (std::size_t i = 0; i < at(p.children); ++i) {
      TreeCell child{.kind = parent.kind,
                     .has = parent.has,
                     .mirrored = parent.mirrored != p.mirrored[i],
                     .level = parent.level + 1,
                     .parent = c};
      for (std::size_t a = 0; a < at(p.corners); ++a) child.nodes[a] = point[at(p.child[i][a])];
      for (std::size_t e = 0; e < at(p.edges); ++e)
        child.edges[e] = edge_of_child(parent, child, e, p.child_edge[i][e], first_inner_edge);
      for (std::size_t s = 0; s < at(p.sides); ++s) {
        auto const [home, number] = p.child_side[i][s];
        if (home == RefinementPattern::Home::side) {
          child.sides[s] = part_of_side(parent.sides[at(number)], side_of(child, s));
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
    cells_[at(c)].first_child = first_child;
    attach(c);
    for (Index child = first_child; child < first_child + p.children; ++child) {
      attach(child);
      if (parent.has != CellNodes::corners) place_nodes(child, c, make_node);
    }
  }

  /// Whether the children of a refined cell are leaves that no neighbour keeps from being merged.
  [[nodiscard]] bool can_be_merged(Index c) const {
    auto const& cell = cells_[at(c)];
    if (cell.first_child < 0) return false;
    auto const& p = cell.pattern();
    for (Index child = cell.first_child; child < cell.first_child + p.children; ++child) {
      if (!is_leaf(child)) return false;
      for (std::size_t e = 0; e < at(p.edges); ++e)
        if (edges_[at(cells_[at(child)].edges[e])].refined > 0) return false;
    }
    return true;
  }

  /// Makes refined cells, each of which can be merged, leaves again. Nodes, cells, edges and sides that
  /// nothing uses any more go; the others move up.
  Renumbering merge(std::vector<Index> const& parents) {
    std::vector<bool> gone(cells_.size(), false);
    for (Index const c : parents) {
      auto& cell = cells_[at(c)];
      Index const first = cell.first_child;
      for (Index child = first; child < first + cell.pattern().children; ++child) {
        detach(child);
        gone[at(child)] = true;
      }
      detach(c);
      cell.first_child = -1;
      attach(c);
    }
    return compact(gone);
  }

  /// The nodes of the element on a cell, in the order of an element's whose corners are cell.nodes.
  struct NodeList {
    std::array<Index, 27> nodes;
    std::size_t count = 0;
    auto begin() const { return nodes.begin(); }
    auto end() const { return nodes.begin() + static_cast<std::ptrdiff_t>(count); }
    Index operator[](std::size_t a) const { return nodes[a]; }
    void push_back(Index node) { nodes[count++] = node; }
  };
  [[nodiscard]] NodeList nodes_of(Index c) const {
    auto const& cell = cells_[at(c)];
    auto const& p = cell.pattern();
    NodeList list;
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
  [[nodiscard]] NodeList element_nodes(Index c) const {
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
    visit("number of nodes", r.nodes_...);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  template <class V>
  static void reserve(std::vector<V>& list, std::size_t more) {
    auto const needed = list.size() + more;
    if (needed > list.capacity()) list.reserve(std::max(needed, 2 * list.size()));
  }

  /// Side s of a cell, as the cell sees it.
  static TreeSide side_of(TreeCell const& cell, std::size_t s) {
    auto const& p = cell.pattern();
    TreeSide side{.level = cell.level, .has = cell.has};
    for (std::size_t k = 0; k < at(p.corners_of_side(static_cast<int>(s))); ++k) {
      side.nodes[k] = cell.nodes[at(p.side[s][k])];
      side.edges[k] = cell.edges[at(p.edges_of_side[s][k])];
    }
    return side;
  }

  struct HashOfNodes {
    template <std::size_t N>
    std::size_t operator()(std::array<Index, N> const& nodes) const {
      std::uint64_t hash = 0;
      for (Index node : nodes) {
        hash = (hash ^ static_cast<std::uint32_t>(node)) * 0x9e3779b97f4a7c15;
        hash ^= hash >> 32;
      }
      return hash;
    }
  };

  void attach(Index c) { count_uses(c, 1); }
  void detach(Index c) { count_uses(c, -1); }
  void count_uses(Index c, int by) {
    auto const& cell = cells_[at(c)];
    auto const& p = cell.pattern();
    for (std::size_t e = 0; e < at(p.edges); ++e) {
      auto& edge = edges_[at(cell.edges[e])];
      (cell.first_child < 0 ? edge.leaves : edge.refined) += by;
    }
    for (std::size_t s = 0; s < at(p.sides); ++s) {
      auto& cells = sides_[at(cell.sides[s])].cells;
      if (by > 0) {
        cells[cells[0] < 0 ? 0 : 1] = c;
      } else {
        if (cells[0] == c) cells[0] = cells[1];
        cells[1] = -1;
      }
    }
  }

  /// (edge, leaf) for each leaf with a whole edge that is bisected, ascending.
  [[nodiscard]] std::vector<std::pair<Index, Index>> leaves_on_bisected_edges() const {
    std::vector<std::pair<Index, Index>> list;
    for (Index c = 0; c < static_cast<Index>(cells_.size()); ++c) {
      auto const& cell = cells_[at(c)];
      if (cell.first_child >= 0) continue;
      for (std::size_t e = 0; e < at(cell.pattern().edges); ++e)
        if (edges_[at(cell.edges[e])].first_half >= 0) list.emplace_back(cell.edges[e], c);
    }
    std::ranges::sort(list);
    return list;
  }

  void bisect(Index e) {
    auto const edge = edges_[at(e)];
    if (edge.first_half >= 0) return;
    edges_[at(e)].first_half = static_cast<Index>(edges_.size());
    TreeEdge half{.parent = e, .level = edge.level + 1, .has = edge.has};
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
  void divide(Index s) {
    auto const side = sides_[at(s)];
    if (side.first_child >= 0) return;
    auto const n = side.corners();
    bool const quad = n == 4;
    sides_[at(s)].first_child = static_cast<Index>(sides_.size());
    auto const inner = sides_[at(s)].first_inner_edge = static_cast<Index>(edges_.size());
    std::array<Index, 4> middle{};
    for (std::size_t k = 0; k < n; ++k) middle[k] = edges_[at(side.edges[k])].middle;
    // Inner edge k joins the middle of edge k to the centre, or round corner k of a triangle.
    for (std::size_t k = 0; k < n; ++k)
      edges_.push_back({.nodes = {middle[k], quad ? side.centre : middle[(k + n - 1) % n]},
                        .level = side.level + 1,
                        .has = side.has});
    TreeSide child{.parent = s, .level = side.level + 1, .has = side.has};
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

  [[nodiscard]] Index edge_of_child(TreeCell const& parent, TreeCell const& child, std::size_t e,
                                    RefinementPattern::Part part, Index first_inner_edge) const {
    if (part.home == RefinementPattern::Home::inside) return first_inner_edge + part.number;
    auto const& p = child.pattern();
    Index const a = child.nodes[at(p.edge[e][0])], b = child.nodes[at(p.edge[e][1])];
    if (part.home == RefinementPattern::Home::edge) {
      Index const whole = parent.edges[at(part.number)];
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
    auto const sorted = [](std::array<Index, 4> nodes) {
      std::ranges::sort(nodes);
      return nodes;
    };
    auto const corners = sorted(wanted.nodes);
    Index part = sides_[at(s)].first_child;
    while (sorted(sides_[at(part)].nodes) != corners) ++part;
    return part;
  }

  /// Gives the element on a new child the nodes between its corners.
  template <class MakeNode>
  void place_nodes(Index child, Index parent, MakeNode const& make_node) {
    auto& cell = cells_[at(child)];
    auto const& p = cell.pattern();
    auto const i = at(child - cells_[at(parent)].first_child);
    auto const mean = [&](auto const& corners, std::size_t count) {
      std::array<double, 3> sum{};
      for (std::size_t k = 0; k < count; ++k)
        for (std::size_t d = 0; d < 3; ++d)
          sum[d] += p.place[at(p.child[i][at(corners[k])])][d] / static_cast<double>(count);
      return sum;
    };
    for (std::size_t e = 0; e < at(p.edges); ++e)
      make_node(edges_[at(cell.edges[e])].middle, mean(p.edge[e], 2));
    if (cell.has != CellNodes::all) return;
    for (std::size_t s = 0; s < at(p.sides); ++s)
      if (p.side_centre[s] >= 0) make_node(sides_[at(cell.sides[s])].centre, mean(p.side[s], 4));
    if (p.centre < 0) return;
    std::array<int, 8> const corners{0, 1, 2, 3, 4, 5, 6, 7};
    make_node(cell.centre, mean(corners, at(p.corners)));
  }

  Renumbering compact(std::vector<bool> const& gone) {
    std::vector<bool> node_used(at(nodes_), false), side_used(sides_.size(), false);
    for (Index c = 0; c < static_cast<Index>(cells_.size()); ++c) {
      if (gone[at(c)]) continue;
      for (Index const node : nodes_of(c)) node_used[at(node)] = true;
    }
    std::vector<bool> edge_used(edges_.size());
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      auto& edge = edges_[e];
      edge_used[e] = edge.leaves + edge.refined > 0;
      if (edge.refined == 0) edge.first_half = -1;
      if (edge.middle >= 0 && !node_used[at(edge.middle)]) edge.middle = -1;
    }
    for (std::size_t s = 0; s < sides_.size(); ++s) {
      auto& side = sides_[s];
      side_used[s] = side.cells[0] >= 0;
      bool const divided = std::ranges::any_of(
          side.cells, [&](Index c) { return c >= 0 && cells_[at(c)].first_child >= 0; });
      if (!divided) side.first_child = side.first_inner_edge = -1;
      if (side.centre >= 0 && !node_used[at(side.centre)]) side.centre = -1;
    }
    for (auto& cell : cells_)
      if (cell.centre >= 0 && !node_used[at(cell.centre)]) cell.centre = -1;

    auto cell_used = gone;
    cell_used.flip();
    auto const node = numbers(node_used), cell = numbers(cell_used), edge = numbers(edge_used),
               side = numbers(side_used);
    auto const move = [](Index& i, std::vector<Index> const& to) {
      if (i >= 0) i = to[at(i)];
    };
    keep(cells_, cell_used);
    keep(edges_, edge_used);
    keep(sides_, side_used);
    for (auto& c : cells_) {
      move(c.parent, cell);
      move(c.first_child, cell);
      move(c.centre, node);
      for (Index& n : c.nodes) move(n, node);
      for (Index& e : c.edges) move(e, edge);
      for (Index& s : c.sides) move(s, side);
    }
    for (auto& e : edges_) {
      for (Index& n : e.nodes) move(n, node);
      move(e.middle, node);
      move(e.parent, edge);
      move(e.first_half, edge);
    }
    for (auto& s : sides_) {
      for (Index& n : s.nodes) move(n, node);
      for (Index& e : s.edges) move(e, edge);
      for (Index& c : s.cells) move(c, cell);
      move(s.centre, node);
      move(s.parent, side);
      move(s.first_child, side);
      move(s.first_inner_edge, edge);
    }
    nodes_ = static_cast<Index>(std::ranges::count(node_used, true));
    return {node, cell};
  }
  static std::vector<Index> numbers(std::vector<bool> const& used) {
    std::vector<Index> list(used.size(), -1);
    Index next = 0;
    for (std::size_t i = 0; i < used.size(); ++i)
      if (used[i]) list[i] = next++;
    return list;
  }
  template <class V>
  static void keep(std::vector<V>& list, std::vector<bool> const& used) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < list.size(); ++i)
      if (used[i]) list[next++] = list[i];
    list.resize(next);
  }

  std::vector<TreeCell> cells_;
  std::vector<TreeEdge> edges_;
  std::vector<TreeSide> sides_;
  Index nodes_ = 0;
  // By their corners, ascending. Only looked up: their order does not matter.
  std::unordered_map<std::array<Index, 2>, Index, HashOfNodes> initial_edges_;
  std::unordered_map<std::array<Index, 4>, Index, HashOfNodes> initial_sides_;
};

}  // namespace pliant
