#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <pliant/cuda/fan_plan.hpp>
#include <pliant/cuda/patch_plan.hpp>

namespace pliant::test {

template <class Planner>
struct HostPlan {
  int patch_size = 0;
  Index patches = 0;
  detail::PatchCounts capacity;
  std::vector<typename Planner::Unit> units;
  std::vector<detail::PatchNode> nodes;
  std::vector<std::uint16_t> diagonals;

  std::size_t node_capacity() const { return static_cast<std::size_t>(capacity.nodes); }
  std::size_t diagonal_capacity() const { return static_cast<std::size_t>(capacity.diagonals); }
};

/// What a GPU makes of a table, by one thread.
template <class Planner>
HostPlan<Planner> plan_on_host(std::vector<std::array<Index, Planner::nodes>> const& table,
                               int patch_size) {
  HostPlan<Planner> plan;
  auto const count = static_cast<Index>(table.size());
  plan.patch_size = patch_size;
  plan.patches = (count + patch_size - 1) / patch_size;
  detail::PlanMemory needed;
  Planner const sizes(needed, 1, patch_size, 0);
  std::vector<Index> words(static_cast<std::size_t>(needed.most()) / sizeof(Index) + 1);
  auto const for_each_patch = [&](auto const& f) {
    for (Index p = 0; p < plan.patches; ++p) {
      Index const first = p * patch_size;
      detail::PlanMemory memory(words.data());
      Planner planner(memory, 1, patch_size, std::min(patch_size, count - first));
      auto const counts =
          planner.count(detail::OneThread{}, table[static_cast<std::size_t>(first)].data(),
                        static_cast<int>(Planner::nodes));
      f(static_cast<std::size_t>(p), planner, counts);
    }
  };
  auto const raise = [](int& most, int n) { most = std::max(most, (n + 3) / 4 * 4); };
  for_each_patch([&](std::size_t, Planner&, detail::PatchCounts const& counts) {
    raise(plan.capacity.nodes, counts.nodes);
    raise(plan.capacity.diagonals, counts.diagonals);
    raise(plan.capacity.fans, counts.fans);
    raise(plan.capacity.slots, counts.slots);
  });
  auto const room = [&](int n) {
    return static_cast<std::size_t>(plan.patches) * static_cast<std::size_t>(n);
  };
  auto const units = static_cast<std::size_t>(Planner::units(patch_size, plan.capacity));
  plan.units.resize(static_cast<std::size_t>(plan.patches) * units);
  plan.nodes.resize(room(plan.capacity.nodes), detail::PatchNode{-2, -2});
  plan.diagonals.resize(room(plan.capacity.diagonals), 0xfffe);
  for_each_patch([&](std::size_t p, Planner& planner, detail::PatchCounts const&) {
    planner.plan(detail::OneThread{}, plan.capacity, plan.units.data() + p * units,
                 plan.nodes.data() + p * plan.node_capacity(),
                 plan.diagonals.data() + p * plan.diagonal_capacity());
  });
  return plan;
}

template <int Nodes>
auto plan_elements_on_host(std::vector<std::array<Index, Nodes>> const& table, int patch_size) {
  return plan_on_host<detail::PatchPlanner<Nodes>>(table, patch_size);
}

}  // namespace pliant::test
