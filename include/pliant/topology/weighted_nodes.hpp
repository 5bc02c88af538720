#pragma once

#include <span>

#include <pliant/math/weighted_rows.hpp>

namespace pliant {

/// A node that comes or goes with a change of topology: its value is a weighted sum over nodes that stay. A view of one in
/// a list, which it must not outlive.
struct NewNode {
  Index node = -1;
  std::span<NodeWeight const> parents;  ///< weights add up to one
};

/// Such nodes.
using WeightedNodes = WeightedRows<NewNode>;

}  // namespace pliant
