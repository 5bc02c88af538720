#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/config.hpp>

namespace pliant {

/// Consecutive elements of a table that keep together when the mesh changes: a backend may plan each block apart from the
/// others, and keep what it planned for blocks that stay.
struct ElementBlocks {
  /// How many elements blocks have in a first mesh, but for the last: 40 cubes of six tetrahedra.
  static constexpr Index usual = 240;

  std::vector<Index> first;  ///< (blocks + 1), elements; empty: cut as suits the backend
  /// (blocks): not zero where the block of this number in the table before a change had the same elements of the same nodes in
  /// the same order, whatever the elements are numbered now. Empty: none.
  std::vector<char> stays{};
  std::vector<Index> first_before{};  ///< (blocks + 1), elements of that table; where blocks stay

  bool some_stay() const { return !stays.empty(); }
  /// How many elements a table has, of which `given` were given.
  Index count(std::size_t given) const {
    return first.empty() ? static_cast<Index>(given) : first.back();
  }
};

namespace detail {

/// Where the elements of blocks are to be found: by the block, the row of the table before a change with the first of its
/// elements; of one that does not stay, −1 less its row in a list of the elements of such blocks, one block after another.
inline std::vector<Index> sources_of(ElementBlocks const& blocks) {
  std::vector<Index> sources(blocks.stays.size());
  Index row = 0;
  for (std::size_t b = 0; b < sources.size(); ++b) {
    sources[b] = blocks.stays[b] != 0 ? blocks.first_before[b] : -1 - row;
    if (blocks.stays[b] == 0) row += blocks.first[b + 1] - blocks.first[b];
  }
  return sources;
}

/// Fills the table after a change, rows of `Width` of which `Nodes` are nodes.
template <int Nodes, int Width>
struct CarryConnectivity {
  Index const *first, *sources;
  Index blocks;
  Index const *before, *rows;  // rows: of Nodes, of blocks that do not stay
  Index* to;

  /// An element of a block.
  PLIANT_HOST_DEVICE void carry(Index block, Index e) const {
    Index const source = sources[block], within = e - first[block];
    Index* const row = to + static_cast<std::ptrdiff_t>(Width) * e;
    if (source < 0) {
      Index const* const own = rows + static_cast<std::ptrdiff_t>(Nodes) * (-1 - source + within);
      for (int a = 0; a < Nodes; ++a) row[a] = own[a];
    } else {
      Index const* const own = before + static_cast<std::ptrdiff_t>(Width) * (source + within);
      for (int a = 0; a < Nodes; ++a) row[a] = own[a];
    }
  }
  /// An element, whose block is searched.
  PLIANT_HOST_DEVICE void operator()(Index e) const {
    Index low = 0, high = blocks;  // the block is in [low, high), and not empty
    while (high - low > 1) {
      Index const middle = low + (high - low) / 2;
      (first[middle] <= e ? low : high) = middle;
    }
    carry(low, e);
  }
};

}  // namespace detail

/// Elements of a backend that take blocks, and the table before a change or null, as last arguments. Where blocks stay, the
/// nodes that are given are those of the elements of the others, one block after another.
template <class Elements, class B>
concept PlansByBlocks = std::constructible_from<
    Elements, B const&, std::vector<std::array<Index, Elements::nodes_per_element>>, int,
    std::vector<Tag> const&, Index, NodeOrder, ElementBlocks const&, Elements const*>;

}  // namespace pliant
