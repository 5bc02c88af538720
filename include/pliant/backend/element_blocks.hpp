#pragma once

#include <array>
#include <concepts>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/config.hpp>

namespace pliant {

/// Consecutive elements of a table that keep together when the mesh changes: a backend may plan each block apart from the
/// others, and keep what it planned for blocks that stay.
struct ElementBlocks {
  std::vector<Index> first;  ///< (blocks + 1), elements; empty: cut as suits the backend
  /// (blocks): not zero where the block of this number in the table before a change had the same elements in the same
  /// order, whatever they and their nodes are numbered now. Empty: none.
  std::vector<char> stays{};
};

/// Elements of a backend that take blocks, and the table before a change or null, as last arguments.
template <class Elements, class B>
concept PlansByBlocks = std::constructible_from<
    Elements, B const&, std::vector<std::array<Index, Elements::nodes_per_element>>, int,
    std::vector<Tag> const&, Index, NodeOrder, ElementBlocks const&, Elements const*>;

}  // namespace pliant
