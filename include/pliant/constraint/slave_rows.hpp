#pragma once

#include <span>
#include <vector>

#include <pliant/constraint/slave.hpp>
#include <pliant/math/weighted_rows.hpp>

namespace pliant {

/// A Slave in a list of many: a view, which the list must outlive.
struct SlaveRow {
  Index node = -1;
  std::span<NodeWeight const> masters;  ///< ascending by node

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("node", r.node...);
    visit("masters", r.masters...);
  }
};

/// Slaves in compressed rows: a mesh can have very many.
using SlaveRows = WeightedRows<SlaveRow>;

namespace detail {

inline SlaveRows rows_of(std::vector<Slave> const& slaves) {
  SlaveRows rows;
  rows.reserve(slaves.size(), 2 * slaves.size());
  for (auto const& [node, masters] : slaves) rows.push_back(node, masters);
  return rows;
}
inline std::vector<Slave> slaves_of(SlaveRows const& rows) {
  std::vector<Slave> slaves;
  slaves.reserve(rows.size());
  for (auto const& [node, masters] : rows)
    slaves.push_back({node, {masters.begin(), masters.end()}});
  return slaves;
}

}  // namespace detail

}  // namespace pliant
