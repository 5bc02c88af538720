#pragma once

#include <cstddef>
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

/// Slaves by other numbers of nodes: numbers[node].
inline std::vector<Slave> renumbered(std::vector<Slave> slaves, std::vector<Index> const& numbers) {
  auto const renumber = [&](Index& node) { node = numbers[static_cast<std::size_t>(node)]; };
  for (Slave& slave : slaves) {
    renumber(slave.node);
    for (auto& [master, weight] : slave.masters) renumber(master);
  }
  return slaves;
}

}  // namespace pliant
