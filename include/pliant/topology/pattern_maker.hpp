#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include <pliant/element/cell.hpp>
#include <pliant/topology/refinement_pattern.hpp>

// Makes the patterns by which cells are divided, when a program is compiled.
namespace pliant::detail {

/// Calls visit(Cell{}) with the shape of a kind. What goes over the corners, edges and sides that it has, a device keeps in
/// registers.
template <class Visit>
PLIANT_HOST_DEVICE constexpr void visit_cell(CellKind kind, Visit const& visit) {
  switch (kind) {
    case CellKind::triangle:
      return visit(Triangle{});
    case CellKind::quadrilateral:
      return visit(Quadrilateral{});
    case CellKind::tetrahedron:
      return visit(Tetrahedron{});
    case CellKind::hexahedron:
      return visit(Hexahedron{});
    case CellKind::wedge:
      return visit(Wedge{});
    case CellKind::pyramid:
      return visit(Pyramid{});
  }
}

template <class Cell>
class PatternMaker {
 public:
  static constexpr RefinementPattern make(Division division = Division::refined) {
    PatternMaker maker;
    maker.place_points();
    if (division == Division::refined)
      maker.refine();
    else
      maker.split(division);
    maker.find_homes();
    maker.count_at_edges();
    return maker.p_;
  }

 private:
  using Place = std::array<double, 3>;
  using Home = RefinementPattern::Home;
  static constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }

  constexpr Place middle(Place const& a, Place const& b) const {
    return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
  }
  constexpr void add_point(Place const& place) { p_.place[at(p_.points++)] = place; }
  constexpr int point_at(Place const& place) const {
    for (int i = 0; i < p_.points; ++i)
      if (p_.place[at(i)] == place) return i;
    return -1;  // out of range where it is used: no constant expression
  }
  constexpr int between(int a, int b) const {
    return point_at(middle(p_.place[at(a)], p_.place[at(b)]));
  }

  constexpr void place_points() {
    p_.dim = Cell::dim;
    p_.corners = Cell::corners;
    for (int a = 0; a < Cell::corners; ++a) {
      Place place{};
      for (int k = 0; k < Cell::dim; ++k) place[at(k)] = Cell::corner(a)[k];
      add_point(place);
    }
    for (auto const& edge : Cell::edges()) {
      p_.edge[at(p_.edges++)] = edge;
      add_point(middle(p_.place[at(edge[0])], p_.place[at(edge[1])]));
    }
    if (Cell::dim == 3) {
      for (auto const& corners : Cell::sides()) {
        auto const s = at(p_.sides++);
        p_.side[s] = {-1, -1, -1, -1};
        for (std::size_t k = 0; k < corners.size(); ++k) p_.side[s][k] = corners[k];
        int const count = p_.corners_of_side(static_cast<int>(s));
        for (int k = 0; k < count; ++k)
          p_.edges_of_side[s][at(k)] =
              edge_between(p_.side[s][at(k)], p_.side[s][at((k + 1) % count)]);
        p_.side_centre[s] = -1;
        if (count == 3) continue;
        p_.side_centre[s] = p_.points;
        add_point(middle(p_.place[at(p_.side[s][0])], p_.place[at(p_.side[s][2])]));
      }
    }
    if (!TensorCell<Cell>) return;
    p_.centre = p_.points;
    add_point({0, 0, 0});
  }
  constexpr int edge_between(int a, int b) const {
    for (int e = 0; e < p_.edges; ++e)
      if ((p_.edge[at(e)][0] == a && p_.edge[at(e)][1] == b) ||
          (p_.edge[at(e)][0] == b && p_.edge[at(e)][1] == a))
        return e;
    return -1;
  }

  constexpr void refine() {
    for (int i = 0; i < p_.corners; ++i) {
      std::array<int, 8> points{};
      for (int j = 0; j < p_.corners; ++j) points[at(j)] = i == j ? i : between(i, j);
      add_child(kind_of<Cell>, points);
    }
    if (std::same_as<Cell, Triangle>)
      add_child(CellKind::triangle, {between(1, 2), between(2, 0), between(0, 1)});
    if (std::same_as<Cell, Wedge>) {
      std::array<int, 9> level{};  // in the middle of each level, from below
      for (int k = 0; k < 3; ++k) {
        level[at(k)] = between((k + 1) % 3, (k + 2) % 3);
        level[at(k + 3)] = between((k + 1) % 3, (k + 2) % 3 + 3);
        level[at(k + 6)] = between((k + 1) % 3 + 3, (k + 2) % 3 + 3);
      }
      add_child(CellKind::wedge, {level[0], level[1], level[2], level[3], level[4], level[5]});
      add_child(CellKind::wedge, {level[3], level[4], level[5], level[6], level[7], level[8]});
    }
    if (std::same_as<Cell, Tetrahedron>) {
      int const m01 = between(0, 1), m02 = between(0, 2), m03 = between(0, 3), m12 = between(1, 2),
                m13 = between(1, 3), m23 = between(2, 3);
      add_child(CellKind::tetrahedron, {m01, m02, m03, m13});
      add_child(CellKind::tetrahedron, {m01, m02, m12, m13});
      add_child(CellKind::tetrahedron, {m02, m03, m13, m23});
      add_child(CellKind::tetrahedron, {m02, m12, m13, m23});
      for (int c = 0; c < p_.children; ++c) p_.mirrored[at(c)] = six_volumes(p_.child[at(c)]) < 0;
    }
    if (std::same_as<Cell, Pyramid>) {
      int const base = between(0, 2);
      add_child(CellKind::pyramid,
                {between(0, 4), between(3, 4), between(2, 4), between(1, 4), base});
      for (int k = 0; k < 4; ++k) {
        int const next = (k + 1) % 4;
        add_child(CellKind::tetrahedron, {between(k, next), between(next, 4), base, between(k, 4)});
      }
    }
  }
  constexpr void split(Division division) {
    p_.halves = false;
    int const first = division == Division::diagonal_1 ? 1 : 0;
    switch (division) {
      case Division::diagonal_0:
      case Division::diagonal_1:
        p_.centre = -1;
        if (std::same_as<Cell, Pyramid>) p_.halved_side = 0;
        for (int k = first; k < first + 3; k += 2)
          add_child(std::same_as<Cell, Pyramid> ? CellKind::tetrahedron : CellKind::triangle,
                    {k % 4, (k + 1) % 4, (k + 2) % 4, std::same_as<Cell, Pyramid> ? 4 : 0});
        break;
      case Division::four_triangles:
        for (int e = 0; e < p_.edges; ++e)
          add_child(CellKind::triangle, {p_.edge[at(e)][0], p_.edge[at(e)][1], p_.centre});
        break;
      case Division::six_pyramids:
        for (auto const& side : p_.side)  // whose corners run round the other way from inside
          add_child(CellKind::pyramid, {side[0], side[3], side[2], side[1], p_.centre});
        break;
      case Division::refined:
        break;
    }
  }
  constexpr void add_child(CellKind kind, std::array<int, 8> const& points) {
    p_.child_kind[at(p_.children)] = kind;
    p_.child[at(p_.children++)] = points;
  }
  constexpr double six_volumes(std::array<int, 8> const& t) const {
    double d[3][3] = {};
    for (int a = 0; a < 3; ++a)
      for (int k = 0; k < 3; ++k)
        d[a][k] = p_.place[at(t[at(a + 1)])][at(k)] - p_.place[at(t[0])][at(k)];
    return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) -
           d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
           d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
  }

  /// The points on edges and sides, a bit each.
  constexpr void find_points_on() {
    for (int e = 0; e < p_.edges; ++e)
      on_edge_[at(e)] = bit(p_.edge[at(e)][0]) | bit(p_.edge[at(e)][1]) | bit(p_.corners + e);
    for (int s = 0; s < p_.sides; ++s) {
      if (p_.side_centre[at(s)] >= 0) on_side_[at(s)] = bit(p_.side_centre[at(s)]);
      for (int k = 0; k < p_.corners_of_side(s); ++k)
        on_side_[at(s)] |= on_edge_[at(p_.edges_of_side[at(s)][at(k)])];
    }
  }
  static constexpr std::uint32_t bit(int point) { return std::uint32_t{1} << point; }

  constexpr void find_homes() {
    find_points_on();
    for (int c = 0; c < p_.children; ++c) {
      auto const i = at(c);
      auto const find = [&]<class Child>(Child) {
        auto const& points = p_.child[i];
        std::size_t j = 0;
        for (auto const& edge : Child::edges())
          p_.child_edge[i][j++] = home_of_edge(points[at(edge[0])], points[at(edge[1])]);
        if constexpr (Child::dim == 3) {
          j = 0;
          for (auto const& side : Child::sides()) {
            std::array<int, 4> own{-1, -1, -1, -1};
            for (std::size_t k = 0; k < side.size(); ++k)
              if (side[k] >= 0) own[k] = points[at(side[k])];
            p_.child_side[i][j++] = home_of_side(own, c);
          }
        }
      };
      visit_cell(p_.child_kind[i], find);
    }
  }
  constexpr void count_at_edges() {
    std::array<std::array<std::uint8_t*, RefinementPattern::most_points>,
               RefinementPattern::most_points>
        first{};  // by the ends of edges
    for (std::size_t i = 0; i < at(p_.children); ++i)
      visit_cell(p_.child_kind[i], [&]<class Child>(Child) {
        std::size_t j = 0;
        for (auto const& edge : Child::edges()) {
          auto const a = at(p_.child[i][at(edge[0])]), b = at(p_.child[i][at(edge[1])]);
          auto& own = first[a < b ? a : b][a < b ? b : a];
          if (own == nullptr) own = &p_.children_at_edge[i][j];
          ++*own;
          ++j;
        }
      });
  }
  constexpr RefinementPattern::Part home_of_edge(int a, int b) {
    std::uint32_t const ends = bit(a) | bit(b);
    for (int e = 0; e < p_.edges; ++e)
      if ((ends & ~on_edge_[at(e)]) == 0) return {Home::edge, e};
    for (int s = 0; s < p_.sides; ++s)
      if ((ends & ~on_side_[at(s)]) == 0) return {Home::side, s};
    for (int i = 0; i < p_.inner_edges; ++i) {
      auto const& known = p_.inner_edge[at(i)];
      if ((known[0] == a && known[1] == b) || (known[0] == b && known[1] == a))
        return {Home::inside, i};
    }
    p_.inner_edge[at(p_.inner_edges)] = {a, b};
    return {Home::inside, p_.inner_edges++};
  }
  constexpr RefinementPattern::Part home_of_side(std::array<int, 4> own, int child) {
    std::uint32_t corners = 0;
    for (int const point : own)
      if (point >= 0) corners |= bit(point);
    for (int s = 0; s < p_.sides; ++s)
      if ((corners & ~on_side_[at(s)]) == 0) return {Home::side, s, corner_in(s, corners)};
    for (int i = 0; i < p_.inner_sides; ++i)
      if (inner_side_[at(i)] == corners) {
        p_.children_at_inner_side[at(i)][1] = child;
        return {Home::inside, i};
      }
    inner_side_[at(p_.inner_sides)] = corners;
    p_.children_at_inner_side[at(p_.inner_sides)][0] = child;
    return {Home::inside, p_.inner_sides++};
  }
  /// Which corner of a side is among points; −1 where none is.
  constexpr int corner_in(int side, std::uint32_t points) const {
    for (int k = 0; k < p_.corners_of_side(side); ++k)
      if ((points & bit(p_.side[at(side)][at(k)])) != 0) return k;
    return -1;
  }

  RefinementPattern p_{};
  std::array<std::uint32_t, RefinementPattern::most_edges> on_edge_{};
  std::array<std::uint32_t, RefinementPattern::most_sides> on_side_{};
  std::array<std::uint32_t, RefinementPattern::most_inner_sides> inner_side_{};  // their corners
};

}  // namespace pliant::detail
