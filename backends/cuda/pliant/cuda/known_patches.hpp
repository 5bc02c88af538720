#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

#include <pliant/cuda/array.hpp>
#include <pliant/cuda/fan_plan.hpp>
#include <pliant/cuda/patch_plan.hpp>

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
  PatchCounts
      changed{};  // the most that any needed where many were planned again; zero: they never were
};

/// Whether patches of such a capacity have room for so much.
PLIANT_HOST_DEVICE bool holds(PatchCounts const& capacity, PatchCounts const& counts) {
  return counts.nodes <= capacity.nodes && counts.diagonals <= capacity.diagonals &&
         counts.fans <= capacity.fans && counts.slots <= capacity.slots;
}

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
/// The least multiples of four.
inline PatchCounts in_fours(PatchCounts const& counts) {
  auto const rounded = [](int n) { return (n + 3) / 4 * 4; };
  return {rounded(counts.nodes), rounded(counts.diagonals), rounded(counts.fans),
          rounded(counts.slots)};
}
inline PatchCounts larger(PatchCounts const& a, PatchCounts const& b) {
  return {std::max(a.nodes, b.nodes), std::max(a.diagonals, b.diagonals), std::max(a.fans, b.fans),
          std::max(a.slots, b.slots)};
}
/// What to give patches room for before it is known what they need: as much as before a change, where few are planned again;
/// else a little more than such patches ever needed, and at first as much as any needs, but for diagonals, so that few have to be
/// planned twice.
template <class Planner>
PatchCounts guessed_capacity(KnownPatches<Planner> const& known, int patch_size) {
  PatchCounts const usual = Planner::usual(patch_size);
  if (known.plan == nullptr) return usual;
  PatchCounts const& before = known.plan->capacity;
  if (!many_change(known)) return before;
  auto const& changed = known.plan->changed;
  auto guess = Planner::most(patch_size);
  if (changed.slots > 0) {
    auto const more = [](int n, int most) { return std::min(n + n / 32, most); };
    guess = in_fours({more(changed.nodes, guess.nodes), 0, more(changed.fans, guess.fans),
                      more(changed.slots, guess.slots)});
  }
  guess.diagonals = 2 * std::max(before.diagonals, usual.diagonals);
  return guess;
}

}  // namespace pliant::detail
