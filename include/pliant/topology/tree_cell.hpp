#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/topology/number_map.hpp>
#include <pliant/topology/patterns.hpp>

// What a CellTree is made of.
namespace pliant {

/// The highest level of a cell, which is refined so often at most.
inline constexpr int most_levels = 63;

/// Which nodes the element on a cell has: its corners; those and one per edge; or one more in each side
/// with four corners and in the middle too.
enum class CellNodes : std::uint8_t { corners, edges, all };

/// A cell of a CellTree, but for its row. A divided cell has its children at first_child, first_child + 1, ...
struct TreeCell {
  CellKind kind = CellKind::triangle;
  CellNodes has = CellNodes::corners;     ///< of a divided cell: when it was divided
  CellNodes had = CellNodes::corners;     ///< of the initial mesh: what it had there
  Division division = Division::refined;  ///< of a divided cell
  bool mirrored = false;  ///< its element has the last two corners in the other order
  std::uint8_t unused = 0;
  std::int16_t level = 0;  ///< how many of its ancestors are refined
  Index parent = -1;
  Index first_child = -1;  ///< -1 for a leaf
  Index centre = -1;       ///< the node in the middle

  /// Of its edges and sides, and of refinement.
  [[nodiscard]] PLIANT_HOST_DEVICE RefinementPattern const& pattern() const {
    return pattern_of(kind);
  }
  /// Of its children.
  [[nodiscard]] PLIANT_HOST_DEVICE RefinementPattern const& divided() const {
    return pattern_of(kind, division);
  }
  /// Whether it is divided between its corners: then its children have its edges and sides in its place.
  [[nodiscard]] PLIANT_HOST_DEVICE bool is_split() const {
    return first_child >= 0 && division != Division::refined;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE std::size_t corners() const {
    return static_cast<std::size_t>(pattern().corners);
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("kind", r.kind...);
    visit("nodes it has", r.has...);
    visit("nodes it had", r.had...);
    visit("division", r.division...);
    visit("mirrored", r.mirrored...);
    visit("level", r.level...);
    visit("parent", r.parent...);
    visit("first child", r.first_child...);
    visit("centre", r.centre...);
  }
};
static_assert(sizeof(TreeCell) == 20);

/// How many cells have an edge as a whole one, up to `most` of each sort, in one number, so that a cell is counted by one
/// addition.
struct CellsAtEdge {
  static constexpr int bits = 21;
  static constexpr Index most = (1 << bits) - 1;

  std::uint64_t all = 0;

  /// What a leaf, or a refined cell, is counted by.
  static PLIANT_HOST_DEVICE std::uint64_t leaf(CellNodes has) {
    return has == CellNodes::corners ? 1 : 1 | std::uint64_t{1} << bits;
  }
  static constexpr std::uint64_t refined_cell = std::uint64_t{1} << 2 * bits;

  [[nodiscard]] PLIANT_HOST_DEVICE Index leaves() const { return part(0); }
  /// Leaves that have nodes between their corners.
  [[nodiscard]] PLIANT_HOST_DEVICE Index raised() const { return part(bits); }
  /// Split cells count by their children.
  [[nodiscard]] PLIANT_HOST_DEVICE Index refined() const { return part(2 * bits); }

 private:
  [[nodiscard]] PLIANT_HOST_DEVICE Index part(int shift) const {
    return static_cast<Index>(all >> shift) & most;
  }
};

/// Copied by 16 bytes at once.
struct alignas(16) TreeEdge {
  /// What divided made it: the edge of which it is a half, a side between whose parts it lies, or a cell inside of which it
  /// lies.
  enum class Home : std::int16_t { edge, side, cell };

  std::array<Index, 2> nodes{-1, -1};
  Index middle = -1;      ///< the node in its middle, or -1
  Index first_half = -1;  ///< from nodes[0] to the middle; the other half follows
  CellsAtEdge cells{};
  Index divided = -1;  ///< its home's number, or -1 for an edge of the initial mesh
  Home home = Home::edge;
  std::int16_t level = 0;  ///< of the cells of which it is a whole edge

  /// The edge of which it is a half, or -1.
  [[nodiscard]] PLIANT_HOST_DEVICE Index parent() const { return in(Home::edge); }
  /// The divided side between whose parts it lies, or -1.
  [[nodiscard]] PLIANT_HOST_DEVICE Index side() const { return in(Home::side); }
  /// The divided cell inside of which it lies, or -1.
  [[nodiscard]] PLIANT_HOST_DEVICE Index cell() const { return in(Home::cell); }
  /// Whether it is an edge of a leaf that has corners only.
  [[nodiscard]] PLIANT_HOST_DEVICE bool is_linear() const {
    return cells.leaves() > cells.raised();
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("nodes", r.nodes...);
    visit("middle", r.middle...);
    visit("first half", r.first_half...);
    visit("cells at it", r.cells.all...);
    visit("divided", r.divided...);
    visit("home", r.home...);
    visit("level", r.level...);
  }

 private:
  [[nodiscard]] PLIANT_HOST_DEVICE Index in(Home wanted) const {
    return home == wanted ? divided : -1;
  }
};
static_assert(sizeof(TreeEdge) == 32);

/// The side of solid cells, refined as a triangle or quadrilateral is. Copied by 16 bytes at once.
struct alignas(16) TreeSide {
  std::array<Index, 4> edges{-1, -1, -1, -1};  ///< edge k joins corner k to the next
  std::array<Index, 2> cells{-1, -1};          ///< of which it is a whole side, on either side
  Index centre = -1;                           ///< the node in its middle, or -1
  Index parent = -1;                           ///< the side of which it is a part
  Index first_child = -1;  ///< of four, or of two triangles between two pyramids that are split
  Index first_inner_edge =
      -1;  ///< of three in a triangle, four in a quadrilateral, or the diagonal
  std::int16_t level = 0;
  std::uint16_t backwards = 0;  ///< bit k: the first node of edge k is not corner k, but the next
  int unused = 0;               ///< without it nvcc stores bytes

  [[nodiscard]] PLIANT_HOST_DEVICE std::size_t corners() const { return edges[3] < 0 ? 3 : 4; }
  [[nodiscard]] PLIANT_HOST_DEVICE bool runs_backwards(std::size_t edge) const {
    return (backwards >> edge & 1) != 0;
  }
  /// One of its cells; −1 where it has none.
  [[nodiscard]] PLIANT_HOST_DEVICE Index any_cell() const {
    return cells[0] >= 0 ? cells[0] : cells[1];
  }
  /// Which of its cells one is. Parts of the side have that one's children at the same place.
  [[nodiscard]] PLIANT_HOST_DEVICE std::size_t place_of(Index cell) const {
    return cells[0] == cell ? 0 : 1;
  }
  /// Its outline as a plane cell.
  [[nodiscard]] PLIANT_HOST_DEVICE RefinementPattern const& pattern() const {
    return pattern_of(corners() == 3 ? CellKind::triangle : CellKind::quadrilateral);
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("edges", r.edges...);
    visit("cells", r.cells...);
    visit("centre", r.centre...);
    visit("parent", r.parent...);
    visit("first child", r.first_child...);
    visit("first inner edge", r.first_inner_edge...);
    visit("level", r.level...);
    visit("edges that run backwards", r.backwards...);
  }
};
static_assert(sizeof(TreeSide) == 48);

/// The nodes of the element on a cell or side, in the element's order.
struct CellNodeList {
  std::array<Index, 27> nodes;
  std::size_t count = 0;
  auto begin() const { return nodes.begin(); }
  auto end() const { return nodes.begin() + static_cast<std::ptrdiff_t>(count); }
  PLIANT_HOST_DEVICE Index operator[](std::size_t a) const { return nodes[a]; }
  PLIANT_HOST_DEVICE void push_back(Index node) { nodes[count++] = node; }
  /// Takes the last two corners of a tetrahedron in the other order, and what lies between the corners with them.
  PLIANT_HOST_DEVICE void mirror() {
    swap(2, 3);
    if (count != 10) return;
    swap(5, 8);  // edges 0-1, 1-2, 2-0, 0-3, 1-3, 2-3
    swap(6, 7);
  }

 private:
  PLIANT_HOST_DEVICE void swap(std::size_t a, std::size_t b) {
    Index const kept = nodes[a];
    nodes[a] = nodes[b];
    nodes[b] = kept;
  }
};

/// How many of each there are.
struct TreeSizes {
  Index cells = 0, edges = 0, sides = 0, nodes = 0;

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("cells", r.cells...);
    visit("edges", r.edges...);
    visit("sides", r.sides...);
    visit("nodes", r.nodes...);
  }
};

/// A node that a split, or another degree, made: where it lies on the cell, and the nodes that the cell had then.
struct PlacedNode {
  Index node = -1;
  Index cell = -1;
  CellNodes had = CellNodes::corners;
  std::array<double, 3> place{};
};

/// Cells of another shape in the place of a leaf.
struct CellSplit {
  Index cell = -1;
  Division division = Division::refined;
};

/// Another degree for a leaf.
struct CellConversion {
  Index cell = -1;
  CellNodes has = CellNodes::corners;
};

/// New numbers of nodes and cells by old ones.
struct Renumbering {
  NumberMap nodes, cells;
};

}  // namespace pliant
