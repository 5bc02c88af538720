#pragma once

#include <algorithm>
#include <cstddef>
#include <unordered_map>
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
  std::unordered_map<Index, std::size_t> position;
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    if (!position.emplace(slaves[i].node, i).second)
      throw Error("compose: node ", slaves[i].node,
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
      auto const found = position.find(master);
      if (found == position.end()) {
        add(master, weight);
        continue;
      }
      if (found->second >= i)
        throw Error("compose: slave node ", slaves[i].node, " has the master ", master,
                    ", a slave that does not come before it; order slaves after their masters");
      for (auto const& [free, share] : slaves[found->second].masters) add(free, weight * share);
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
  std::ranges::sort(slaves, {}, &Slave::node);  // as an Interpolation wants them
  return slaves;
}

}  // namespace pliant
