#pragma once

#include <algorithm>
#include <array>

#include <pliant/config.hpp>
#include <pliant/cuda/slot_planner.hpp>

// How much of each thing patches have room for.
namespace pliant::detail {

/// Whether patches of such a capacity have room for so much.
PLIANT_HOST_DEVICE bool holds(PatchCounts const& capacity, PatchCounts const& counts) {
  return counts.nodes <= capacity.nodes && counts.diagonals <= capacity.diagonals &&
         counts.fans <= capacity.fans && counts.slots <= capacity.slots;
}

/// The least multiples of four.
inline PatchCounts in_fours(PatchCounts const& counts) {
  auto const rounded = [](int n) { return (n + 3) / 4 * 4; };
  return {rounded(counts.nodes), rounded(counts.diagonals), rounded(counts.fans),
          rounded(counts.slots)};
}

/// The most that any patch needed behind the last change that had many of them planned again, of those that left a table no fewer patches
/// and of those that left it fewer: a mesh that is refined and coarsened by turns needs either again. Zero: there was none.
class LastNeeds {
 public:
  [[nodiscard]] PatchCounts const& behind(bool leaves_fewer) const { return needs_[leaves_fewer]; }
  void note(bool leaves_fewer, PatchCounts const& counts) { needs_[leaves_fewer] = counts; }

 private:
  std::array<PatchCounts, 2> needs_{};
};

/// What to give patches room for where a change has many of them planned again, so that few are planned twice: a little more than
/// such patches needed the last time (`changed`), and at first (zero) as much as any needs; of diagonals, about which little is
/// known, twice as many. `before`: what they had room for before it.
template <class Planner>
PatchCounts capacity_of_many(PatchCounts const& before, PatchCounts const& changed,
                             int patch_size) {
  auto guess = Planner::most(patch_size);
  bool const is_known = changed.slots > 0;
  if (is_known) {
    auto const more = [](int n, int most) { return std::min(n + n / 32, most); };
    guess = in_fours({more(changed.nodes, guess.nodes), 0, more(changed.fans, guess.fans),
                      more(changed.slots, guess.slots)});
  }
  guess.diagonals =
      2 * std::max((is_known ? changed : before).diagonals, Planner::usual(patch_size).diagonals);
  return guess;
}
/// Whether patches that have room for a guess may keep it: what a patch stages shares the memory of a multiprocessor with others,
/// so that there is little room to spare.
inline bool may_keep(PatchCounts const& guess, PatchCounts const& counts) {
  return holds(guess, counts) && guess.slots <= counts.slots + counts.slots / 16 &&
         guess.nodes <= counts.nodes + counts.nodes / 16;
}

}  // namespace pliant::detail
