#pragma once

#include <array>
#include <cstddef>

#include <pliant/config.hpp>

// The numbers of cells' corners, edges and sides in a CellTree, which stay as they are while a cell is there.
namespace pliant {

/// Where those of a cell lie.
struct CellRow {
  Index *nodes, *edges, *sides;
};

/// Those of a cell that is made; −1 behind those that it has.
struct CellNumbers {
  std::array<Index, 8> nodes{-1, -1, -1, -1, -1, -1, -1, -1};
  std::array<Index, 12> edges{-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
  std::array<Index, 6> sides{-1, -1, -1, -1, -1, -1};

  [[nodiscard]] PLIANT_HOST_DEVICE CellRow row() {
    return {nodes.data(), edges.data(), sides.data()};
  }
};

/// Some of a row, copied by 16 bytes at once.
struct alignas(16) RowEntry {
  static constexpr std::size_t count = 8;
  std::array<Index, count> numbers;

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("numbers", r.numbers...);
  }
};

/// How the rows of a tree lie, one behind the other: of so many entries as the cells need which have most.
struct RowLayout {
  int shift = 2;  ///< a row has 1 << shift entries
  Index first_edge = 8, first_side = 20;

  static constexpr PLIANT_HOST_DEVICE RowLayout of_plane_cells() { return {0, 4, 8}; }
  static constexpr PLIANT_HOST_DEVICE RowLayout of_tetrahedra() { return {1, 4, 10}; }
  static constexpr PLIANT_HOST_DEVICE RowLayout of_solid_cells() { return {2, 8, 20}; }

  /// How many edges a cell has at most.
  [[nodiscard]] Index most_edges() const { return first_side - first_edge; }
  /// The first entry of a cell's row.
  [[nodiscard]] PLIANT_HOST_DEVICE std::size_t entry(std::size_t cell) const {
    return cell << shift;
  }
  /// Number i of a row.
  [[nodiscard]] constexpr PLIANT_HOST_DEVICE Index number(CellNumbers const& of, Index i) const {
    if (i < first_edge) return of.nodes[static_cast<std::size_t>(i)];
    if (i < first_side) return of.edges[static_cast<std::size_t>(i - first_edge)];
    auto const side = static_cast<std::size_t>(i - first_side);
    return side < of.sides.size() ? of.sides[side] : -1;
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("entries of a row", r.shift...);
    visit("first edge", r.first_edge...);
    visit("first side", r.first_side...);
  }
};

}  // namespace pliant
