#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <pliant/element/cell.hpp>

namespace pliant {

/// The cells that can be divided.
enum class CellKind : std::uint8_t {
  triangle,
  quadrilateral,
  tetrahedron,
  hexahedron,
  wedge,
  pyramid
};

template <class Cell>
inline constexpr bool has_pattern = !std::same_as<Cell, Segment>;
template <class Cell>
  requires has_pattern<Cell>
inline constexpr CellKind kind_of = std::same_as<Cell, Triangle>        ? CellKind::triangle
                                    : std::same_as<Cell, Quadrilateral> ? CellKind::quadrilateral
                                    : std::same_as<Cell, Tetrahedron>   ? CellKind::tetrahedron
                                    : std::same_as<Cell, Hexahedron>    ? CellKind::hexahedron
                                    : std::same_as<Cell, Wedge>         ? CellKind::wedge
                                                                        : CellKind::pyramid;

/// How a cell is divided: refined, into cells half its size, or split into cells of another shape, between its corners: a
/// quadrilateral along the diagonal from corner 0 or 1 or into four triangles around its centre, a hexahedron into
/// six pyramids around its centre, one on each side, a pyramid into two tetrahedra along a diagonal of its base.
enum class Division : std::uint8_t {
  refined,
  diagonal_0,
  diagonal_1,
  four_triangles,
  six_pyramids
};

/// How a cell is divided (see Division): its points, the children between them, and where the children's
/// edges and sides lie. Points are the corners, then the middles of the edges, then the centres of sides
/// with four corners (in 3D), then the centre of a quadrilateral or hexahedron, each in the cell's order.
/// Children of a refined cell (red refinement): child i lies in corner i and is numbered like its parent, so that both
/// have the same corner i. Further children lie in the middle: that of a triangle is the parent turned by half a turn;
/// those of a tetrahedron divide an octahedron along the diagonal between the middles of the edges 0-2 and 1-3, in
/// the numbering of Bey (Computing 55 (1995) 355), which makes no more than three classes of similar
/// tetrahedra in all generations, some of them mirrored: their determinant is of the other sign. Those of a pyramid are
/// a pyramid upside down on the centre of the base, and a tetrahedron at each edge of the base. Children of a split
/// cell, one on each of its edges or sides, begin with the corners of that.
struct RefinementPattern {
  static constexpr std::size_t most_corners = 8, most_points = 27, most_children = 10,
                               most_edges = 12, most_sides = 6, most_inner_sides = 13;
  /// Where an edge or a side of a child lies: on an edge or side of the parent, or inside it, and the
  /// number of that edge, side, or inner edge or side. Of a side on a side that is divided in four: at which of that one's corners,
  /// or −1 in the middle of a triangle.
  enum class Home : std::uint8_t { edge, side, inside };
  struct Part {
    Home home = Home::inside;
    int number = -1;
    int corner = -1;
  };

  int dim = 0, corners = 0, edges = 0, sides = 0, points = 0, children = 0;  // sides: 0 in 2D
  int inner_edges = 0, inner_sides = 0;
  int centre =
      -1;  ///< the point in the middle of the cell, or −1 where it has none, or a split needs none
  bool halves = true;    ///< whether edges and sides are divided, and children half as large
  int halved_side = -1;  ///< the side that a split divides in two triangles, or −1
  std::array<std::array<double, 3>, most_points> place{};  ///< of points, on the cell
  std::array<std::array<int, 2>, most_edges> edge{};       ///< their corners
  std::array<std::array<int, 4>, most_sides>
      side{};  ///< their corners; −1 behind those of a triangle
  std::array<std::array<int, 4>, most_sides> edges_of_side{};  ///< edge k begins at its corner k
  std::array<int, most_sides> side_centre{};                   ///< points, or −1
  std::array<CellKind, most_children> child_kind{};
  std::array<std::array<int, most_corners>, most_children> child{};  ///< their corners, as points
  std::array<bool, most_children> mirrored{};
  std::array<std::array<int, 2>, most_edges> inner_edge{};  ///< their ends, as points
  std::array<std::array<Part, most_edges>, most_children> child_edge{};
  std::array<std::array<Part, most_sides>, most_children> child_side{};
  /// How many children have an edge, at the first of them; 0 at others.
  std::array<std::array<std::uint8_t, most_edges>, most_children> children_at_edge{};
  std::array<std::array<int, 2>, most_inner_sides> children_at_inner_side{};  ///< in their order

  constexpr int corners_of_side(int s) const {
    return side[static_cast<std::size_t>(s)][3] < 0 ? 3 : 4;
  }
};

}  // namespace pliant
