#pragma once

#include <utility>
#include <vector>

#include <pliant/config.hpp>

namespace pliant {

/// A node that does not move freely: its displacement is the weighted sum of its masters', and its
/// force and mass are handed to them with the same weights.
struct Slave {
  Index node = -1;
  std::vector<std::pair<Index, double>> masters;  ///< (node, weight), ascending by node

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("node", r.node...);
    visit("masters", r.masters...);
  }
};

}  // namespace pliant
