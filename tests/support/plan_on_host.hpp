#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <pliant/backend/patch_cuts.hpp>
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

/// What a GPU makes of a table, by one thread. `least`: a capacity that patches have at least.
template <class Planner>
HostPlan<Planner> plan_on_host(std::vector<std::array<Index, Planner::nodes>> const& table,
                               detail::PatchCuts const& cuts,
                               detail::PatchCounts const& least = {}) {
  HostPlan<Planner> plan;
  plan.capacity = least;
  int const patch_size = cuts.size();
  plan.patch_size = patch_size;
  plan.patches = cuts.count();
  detail::PlanMemory needed;
  Planner const sizes(needed, patch_size, 0);
  std::vector<Index> words(static_cast<std::size_t>(needed.most()) / sizeof(Index) + 1);
  auto const for_each_patch = [&](auto const& f) {
    for (Index p = 0; p < plan.patches; ++p) {
      Index const first = cuts.first(p);
      detail::PlanMemory memory(words.data());
      Planner planner(memory, patch_size, cuts.first(p + 1) - first);
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
  auto const first_unit = [&](Index patch) {
    return static_cast<std::size_t>(Planner::first_unit(patch, cuts.first(patch), plan.capacity));
  };
  plan.units.resize(first_unit(plan.patches));
  plan.nodes.resize(room(plan.capacity.nodes), detail::PatchNode{-2, -2});
  plan.diagonals.resize(room(plan.capacity.diagonals), 0xfffe);
  for_each_patch([&](std::size_t p, Planner& planner, detail::PatchCounts const&) {
    planner.plan(detail::OneThread{}, plan.capacity,
                 plan.units.data() + first_unit(static_cast<Index>(p)),
                 plan.nodes.data() + p * plan.node_capacity(),
                 plan.diagonals.data() + p * plan.diagonal_capacity());
  });
  return plan;
}

template <class Planner>
HostPlan<Planner> plan_on_host(std::vector<std::array<Index, Planner::nodes>> const& table,
                               int patch_size) {
  return plan_on_host<Planner>(table,
                               detail::PatchCuts(static_cast<Index>(table.size()), patch_size));
}

template <int Nodes>
auto plan_elements_on_host(std::vector<std::array<Index, Nodes>> const& table, int patch_size) {
  return plan_on_host<detail::PatchPlanner<Nodes>>(table, patch_size);
}

}  // namespace pliant::test
