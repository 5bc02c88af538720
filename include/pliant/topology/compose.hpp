#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/constraint/slave.hpp>
#include <pliant/error.hpp>

namespace pliant {

/// Replaces masters that are slaves themselves by their own masters, until every master is free;
/// a master reached along several ways appears once, with the sum of the weights. The result ascends by node.
/// A slave must come after the slaves among its masters. Throws Error where one does not (which is
/// so for any circle of slaves) and where a node is a slave twice.
[[nodiscard]] inline std::vector<Slave> compose(std::vector<Slave> slaves) {
  constexpr Index none = -1;
  std::vector<Index> position;  // in the list, by node
  auto const position_of = [&](Index node) {
    return static_cast<std::size_t>(node) < position.size()
               ? position[static_cast<std::size_t>(node)]
               : none;
  };
  for (Index i = 0; Slave const& slave : slaves) {
    if (slave.node < 0) throw Error("compose: there is no node ", slave.node);
    auto const node = static_cast<std::size_t>(slave.node);
    if (node >= position.size()) position.resize(std::max(node + 1, 2 * position.size()), none);
    if (std::exchange(position[node], i++) != none)
      throw Error("compose: node ", slave.node,
                  " is a slave twice; list each slave once, with all of its masters");
  }
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    // Ascending, equal ones in the order in which they come, so that they are summed in a fixed order.
    std::vector<std::pair<Index, double>> composed;
    auto const add = [&](Index master, double weight) {
      composed.insert(
          std::ranges::upper_bound(composed, master, {}, &std::pair<Index, double>::first),
          {master, weight});
    };
    for (auto const& [master, weight] : slaves[i].masters) {
      Index const found = position_of(master);
      if (found == none) {
        add(master, weight);
        continue;
      }
      if (static_cast<std::size_t>(found) >= i)
        throw Error("compose: slave node ", slaves[i].node, " has the master ", master,
                    ", a slave that does not come before it; order slaves after their masters");
      for (auto const& [free, share] : slaves[static_cast<std::size_t>(found)].masters)
        add(free, weight * share);
    }
    auto& masters = slaves[i].masters;
    masters.clear();
    for (auto const& [free, weight] : composed) {
      if (!masters.empty() && masters.back().first == free)
        masters.back().second += weight;
      else
        masters.emplace_back(free, weight);
    }
  }
  std::vector<Slave> ascending;  // as an Interpolation wants them
  ascending.reserve(slaves.size());
  for (Index const found : position)
    if (found != none) ascending.push_back(std::move(slaves[static_cast<std::size_t>(found)]));
  return ascending;
}

}  // namespace pliant
