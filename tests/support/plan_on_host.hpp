#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

// By its place: plans are tested without CUDA, and so without its folder among the includes.
#include "../../backends/cuda/pliant/cuda/patch_plan.hpp"

namespace pliant::test {

template <int Nodes>
struct HostPlan {
  int patch_size = 0;
  Index patches = 0;
  int node_capacity = 0, diagonal_capacity = 0;
  std::vector<detail::PatchRow<Nodes>> rows;
  std::vector<detail::PatchNode> nodes;
  std::vector<std::uint16_t> diagonals;
};

/// What a GPU makes of a table, by one thread.
template <int Nodes>
HostPlan<Nodes> plan_on_host(std::vector<std::array<Index, Nodes>> const& table, int patch_size) {
  using Planner = detail::PatchPlanner<Nodes>;
  HostPlan<Nodes> plan;
  auto const count = static_cast<Index>(table.size());
  plan.patch_size = patch_size;
  plan.patches = (count + patch_size - 1) / patch_size;
  plan.rows.resize(table.size());
  std::vector<Index> memory(static_cast<std::size_t>(Planner::bytes(patch_size)) / sizeof(Index) +
                            1);
  auto const for_each_patch = [&](auto const& f) {
    for (Index p = 0; p < plan.patches; ++p) {
      Index const first = p * patch_size;
      Planner planner(memory.data(), patch_size, std::min(patch_size, count - first));
      planner.read(table[static_cast<std::size_t>(first)].data(), Nodes, 0, 1);
      f(static_cast<std::size_t>(p), planner, planner.number_nodes());
    }
  };
  auto const in_fours = [](int n) { return (n + 3) / 4 * 4; };
  for_each_patch([&](std::size_t, Planner&, detail::PatchCounts const& counts) {
    plan.node_capacity = std::max(plan.node_capacity, in_fours(counts.nodes));
    plan.diagonal_capacity = std::max(plan.diagonal_capacity, in_fours(counts.diagonals));
  });
  auto const rows = [&](int capacity) {
    return static_cast<std::size_t>(plan.patches) * static_cast<std::size_t>(capacity);
  };
  plan.nodes.resize(rows(plan.node_capacity), detail::PatchNode{-2, -2});
  plan.diagonals.resize(rows(plan.diagonal_capacity), 0xfffe);
  for_each_patch([&](std::size_t p, Planner& planner, detail::PatchCounts const& counts) {
    planner.sort_by_valence(counts);
    planner.write_nodes(counts, &plan.nodes[p * static_cast<std::size_t>(plan.node_capacity)],
                        plan.node_capacity,
                        &plan.diagonals[p * static_cast<std::size_t>(plan.diagonal_capacity)],
                        plan.diagonal_capacity, 0, 1);
    planner.assign_slots();
    planner.write_rows(&plan.rows[p * static_cast<std::size_t>(patch_size)], 0, 1);
  });
  return plan;
}

}  // namespace pliant::test
