#pragma once

#include <cstdint>

#include <pliant/backend/backend.hpp>

namespace pliant::detail {

/// Which entries of an array are not zero, for select.
template <class U>
struct IsMarked {
  U const* marks;
  PLIANT_HOST_DEVICE bool operator()(Index i) const { return marks[i] != U{0}; }
};

/// Whether an element has a marked node.
template <int Nodes>
struct HasMarkedNode {
  ElementRows rows{};
  std::uint8_t const* marks = nullptr;  // by node

  PLIANT_HOST_DEVICE bool operator()(Index e) const {
    Index const* const nodes = rows[e];
    std::uint8_t any = 0;  // of all nodes, without a branch for each
    for (int a = 0; a < Nodes; ++a) any |= marks[nodes[a]];
    return any != 0;
  }
};

}  // namespace pliant::detail
