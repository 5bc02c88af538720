#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <pliant/element/cell.hpp>

namespace pliant {

/// The cells that can be refined. (A pyramid's children would be pyramids and tetrahedra.)
enum class CellKind : std::uint8_t { triangle, quadrilateral, tetrahedron, hexahedron, wedge };

template <class Cell>
inline constexpr bool has_pattern = !std::same_as<Cell, Pyramid> && !std::same_as<Cell, Segment>;
template <class Cell>
  requires has_pattern<Cell>
inline constexpr CellKind kind_of = std::same_as<Cell, Triangle>        ? CellKind::triangle
                                    : std::same_as<Cell, Quadrilateral> ? CellKind::quadrilateral
                                    : std::same_as<Cell, Tetrahedron>   ? CellKind::tetrahedron
                                    : std::same_as<Cell, Hexahedron>    ? CellKind::hexahedron
                                                                        : CellKind::wedge;

/// How a cell is refined (red refinement): its points, the children between them, and where the children's
/// edges and sides lie. Points are the corners, then the middles of the edges, then the centres of sides
/// with four corners (in 3D), then the centre of a quadrilateral or hexahedron, each in the cell's order.
/// Child i lies in corner i and is numbered like its parent, so that both have the same corner i. Further
/// children lie in the middle: that of a triangle is the parent turned by half a turn; those of a
/// tetrahedron divide an octahedron along the diagonal between the middles of the edges 0-2 and 1-3, in
/// the numbering of Bey (Computing 55 (1995) 355), which makes no more than three classes of similar
/// tetrahedra in all generations. Some of these are mirrored: their determinant is of the other sign.
struct RefinementPattern {
  static constexpr std::size_t most_corners = 8, most_points = 27, most_children = 8,
                               most_edges = 12, most_sides = 6;
  /// Where an edge or a side of a child lies: on an edge or side of the parent, or inside it, and the
  /// number of that edge, side, or inner edge or side.
  enum class Home : std::uint8_t { edge, side, inside };
  struct Part {
    Home home = Home::inside;
    int number = -1;
  };

  int dim = 0, corners = 0, edges = 0, sides = 0, points = 0, children = 0;  // sides: 0 in 2D
  int inner_edges = 0, inner_sides = 0;
  int centre = -1;  ///< the point in the middle of the cell, or −1
  std::array<std::array<double, 3>, most_points> place{};  ///< of points, on the cell
  std::array<std::array<int, 2>, most_edges> edge{};       ///< their corners
  std::array<std::array<int, 4>, most_sides>
      side{};  ///< their corners; −1 behind those of a triangle
  std::array<std::array<int, 4>, most_sides> edges_of_side{};  ///< edge k begins at its corner k
  std::array<int, most_sides> side_centre{};                   ///< points, or −1
  std::array<std::array<int, most_corners>, most_children> child{};  ///< their corners, as points
  std::array<bool, most_children> mirrored{};
  std::array<std::array<int, 2>, most_edges> inner_edge{};  ///< their ends, as points
  std::array<std::array<Part, most_edges>, most_children> child_edge{};
  std::array<std::array<Part, most_sides>, most_children> child_side{};

  constexpr int corners_of_side(int s) const {
    return side[static_cast<std::size_t>(s)][3] < 0 ? 3 : 4;
  }
};

namespace detail {

template <class Cell>
class PatternMaker {
 public:
  static constexpr RefinementPattern make() {
    PatternMaker maker;
    maker.place_points();
    maker.make_children();
    maker.find_homes();
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

  constexpr void make_children() {
    for (int i = 0; i < p_.corners; ++i)
      for (int j = 0; j < p_.corners; ++j) p_.child[at(i)][at(j)] = i == j ? i : between(i, j);
    p_.children = p_.corners;
    if (std::same_as<Cell, Triangle>) add_child({between(1, 2), between(2, 0), between(0, 1)});
    if (std::same_as<Cell, Wedge>) {
      std::array<int, 9> level{};  // in the middle of each level, from below
      for (int k = 0; k < 3; ++k) {
        level[at(k)] = between((k + 1) % 3, (k + 2) % 3);
        level[at(k + 3)] = between((k + 1) % 3, (k + 2) % 3 + 3);
        level[at(k + 6)] = between((k + 1) % 3 + 3, (k + 2) % 3 + 3);
      }
      add_child({level[0], level[1], level[2], level[3], level[4], level[5]});
      add_child({level[3], level[4], level[5], level[6], level[7], level[8]});
    }
    if (std::same_as<Cell, Tetrahedron>) {
      int const m01 = between(0, 1), m02 = between(0, 2), m03 = between(0, 3), m12 = between(1, 2),
                m13 = between(1, 3), m23 = between(2, 3);
      add_child({m01, m02, m03, m13});
      add_child({m01, m02, m12, m13});
      add_child({m02, m03, m13, m23});
      add_child({m02, m12, m13, m23});
      for (int c = 0; c < p_.children; ++c) p_.mirrored[at(c)] = six_volumes(p_.child[at(c)]) < 0;
    }
  }
  constexpr void add_child(std::array<int, 8> const& points) {
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

  constexpr bool on_edge(int e, int point) const {
    return point == p_.edge[at(e)][0] || point == p_.edge[at(e)][1] || point == p_.corners + e;
  }
  constexpr bool on_side(int s, int point) const {
    if (point == p_.side_centre[at(s)]) return true;
    for (int k = 0; k < p_.corners_of_side(s); ++k)
      if (on_edge(p_.edges_of_side[at(s)][at(k)], point)) return true;
    return false;
  }

  constexpr void find_homes() {
    std::array<std::array<int, 4>, 12> inner_sides{};
    for (int c = 0; c < p_.children; ++c) {
      auto const& points = p_.child[at(c)];
      for (int j = 0; j < p_.edges; ++j)
        p_.child_edge[at(c)][at(j)] =
            home_of_edge(points[at(p_.edge[at(j)][0])], points[at(p_.edge[at(j)][1])]);
      for (int j = 0; j < p_.sides; ++j) {
        std::array<int, 4> own{-1, -1, -1, -1};
        int const count = p_.corners_of_side(j);
        for (int k = 0; k < count; ++k) own[at(k)] = points[at(p_.side[at(j)][at(k)])];
        p_.child_side[at(c)][at(j)] = home_of_side(own, count, inner_sides);
      }
    }
  }
  constexpr RefinementPattern::Part home_of_edge(int a, int b) {
    for (int e = 0; e < p_.edges; ++e)
      if (on_edge(e, a) && on_edge(e, b)) return {Home::edge, e};
    for (int s = 0; s < p_.sides; ++s)
      if (on_side(s, a) && on_side(s, b)) return {Home::side, s};
    for (int i = 0; i < p_.inner_edges; ++i) {
      auto const& known = p_.inner_edge[at(i)];
      if ((known[0] == a && known[1] == b) || (known[0] == b && known[1] == a))
        return {Home::inside, i};
    }
    p_.inner_edge[at(p_.inner_edges)] = {a, b};
    return {Home::inside, p_.inner_edges++};
  }
  constexpr RefinementPattern::Part home_of_side(std::array<int, 4> own, int count,
                                                 std::array<std::array<int, 4>, 12>& inner) {
    for (int s = 0; s < p_.sides; ++s) {
      bool all = true;
      for (int k = 0; k < count; ++k) all = all && on_side(s, own[at(k)]);
      if (all) return {Home::side, s};
    }
    for (int k = 0; k < 4; ++k)  // ascending: the same for both children beside it
      for (int l = k + 1; l < 4; ++l)
        if (own[at(l)] < own[at(k)]) {
          int const swapped = own[at(k)];
          own[at(k)] = own[at(l)];
          own[at(l)] = swapped;
        }
    for (int i = 0; i < p_.inner_sides; ++i)
      if (inner[at(i)] == own) return {Home::inside, i};
    inner[at(p_.inner_sides)] = own;
    return {Home::inside, p_.inner_sides++};
  }

  RefinementPattern p_{};
};

inline constexpr std::array<RefinementPattern, 5> patterns{
    PatternMaker<Triangle>::make(), PatternMaker<Quadrilateral>::make(),
    PatternMaker<Tetrahedron>::make(), PatternMaker<Hexahedron>::make(),
    PatternMaker<Wedge>::make()};

}  // namespace detail

constexpr RefinementPattern const& pattern_of(CellKind kind) {
  return detail::patterns[static_cast<std::size_t>(kind)];
}

/// Where a point of a child's element lies on its parent's. `mirrored`: whether the parent is.
template <class Cell>
constexpr Vector<double, Cell::dim> on_parent(Vector<double, Cell::dim> const& xi, int child,
                                              bool mirrored = false) {
  auto const& p = pattern_of(kind_of<Cell>);
  auto const own = static_cast<std::size_t>(child);
  auto weight = Cell::linear(xi);
  auto const swap = [](auto& v, int i, int j) {
    double const kept = v[i];
    v[i] = v[j];
    v[j] = kept;
  };
  // Mirrored elements have their last two corners in the other order, and so two coordinates.
  if constexpr (std::same_as<Cell, Tetrahedron>)
    if (mirrored != p.mirrored[own]) swap(weight, 2, 3);
  auto place = Vector<double, Cell::dim>::zero();
  for (int a = 0; a < Cell::corners; ++a)
    for (int k = 0; k < Cell::dim; ++k)
      place[k] +=
          weight[a] * p.place[static_cast<std::size_t>(p.child[own][static_cast<std::size_t>(a)])]
                             [static_cast<std::size_t>(k)];
  if constexpr (std::same_as<Cell, Tetrahedron>)
    if (mirrored) swap(place, 1, 2);
  return place;
}

}  // namespace pliant
