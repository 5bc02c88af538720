#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

#include <pliant/cuda/array.hpp>
#include <pliant/cuda/fan_plan.hpp>
#include <pliant/cuda/patch_plan.hpp>
#include <pliant/cuda/plan_capacity.hpp>

// What patches are planned to, and what that tells of their capacity after a change.
namespace pliant::detail {

/// The patches of an element table.
template <class Planner>
struct PatchPlan {
  PatchCounts capacity;                       // of a patch; multiples of 4
  DeviceArray<typename Planner::Unit> units;  // (patches, Planner::units)
  DeviceArray<PatchNode> nodes;               // (patches, node capacity)
  DeviceArray<std::uint16_t> diagonals;       // (patches, diagonal capacity)
  DeviceArray<PatchCounts> counts;            // (patches): what each has
  LastNeeds needs{};                          // of this table and those before changes
};

/// What a table was planned to before a change, with its patches as PatchRanges::first has them, and by the patch now the patch
/// there, or −1.
template <class Planner>
struct KnownPatches {
  PatchPlan<Planner> const* plan = nullptr;
  Index const* first = nullptr;
  std::vector<Index> patches{};
};

/// Whether many patches of a table are planned again.
template <class Planner>
bool many_change(KnownPatches<Planner> const& known) {
  auto const planned = std::ranges::count(known.patches, Index{-1});
  return known.plan != nullptr && 8 * planned >= std::ssize(known.patches);
}
/// Whether there are fewer patches than before.
template <class Planner>
bool leaves_fewer(KnownPatches<Planner> const& known) {
  return known.plan != nullptr && known.patches.size() < known.plan->counts.size();
}
/// What to give patches room for before it is known what they need.
template <class Planner>
PatchCounts guessed_capacity(KnownPatches<Planner> const& known, int patch_size) {
  if (known.plan == nullptr) return Planner::usual(patch_size);
  if (!many_change(known)) return known.plan->capacity;
  return capacity_of_many<Planner>(known.plan->capacity,
                                   known.plan->needs.behind(leaves_fewer(known)), patch_size);
}

}  // namespace pliant::detail
