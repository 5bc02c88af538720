#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <pliant/backend/backend.hpp>

namespace pliant {

/// Where the sums about one element type stand in an array of doubles.
template <int Groups>
struct CounterLayout {
  static constexpr int steps_of(int group) { return group; }
  static constexpr int moves(int from, int to) { return Groups + from * Groups + to; }
  static constexpr int energy(int from, int to) {
    return Groups + Groups * Groups + from * Groups + to;
  }
  static constexpr int kinetic(int from, int to) {
    return Groups + 2 * Groups * Groups + from * Groups + to;
  }
  /// Moves whose change of energy is not finite, and so is in no sum.
  static constexpr int unbooked = Groups + 3 * Groups * Groups;
  static constexpr int count = unbooked + 1;
};

/// Counts up to the largest number and stays there.
PLIANT_HOST_DEVICE std::int32_t one_more(std::int32_t count) {
  return count < std::numeric_limits<std::int32_t>::max() ? count + 1 : count;
}

/// What is counted of the elements of one type while they change groups; made when adaptation first
/// looks at them, so that other scenes do not pay.
template <Backend B, int Groups>
struct GroupStatistics {
  using Counters = CounterLayout<Groups>;

  typename B::template Array<std::int64_t> since;  // (elements): step of the last change of group
  typename B::template Array<std::int32_t> switches;  // (elements): changes of group so far
  /// Element-steps per group of the stays that are over (an element that leaves a group adds its
  /// steps there), moves between groups and their changes of strain and kinetic energy, J.
  typename B::template Array<double> counters;
  bool open = false;

  void start(B const& backend, Index elements, std::int64_t step) {
    auto const n = static_cast<std::size_t>(elements);
    since = upload(backend, std::vector<std::int64_t>(n, step));
    switches = zeros<std::int32_t>(backend, n);
    counters = zeros<double>(backend, Counters::count);
    open = true;
  }
  /// Counts that a user put elements from the groups `before` into the groups `after` at a step.
  void enter(std::vector<Tag> const& before, std::vector<Tag> const& after, std::int64_t step) {
    auto from = download<std::int64_t>(since);
    auto times = download<std::int32_t>(switches);
    auto sums = download<double>(counters);
    for (std::size_t e = 0; e < before.size(); ++e) {
      if (before[e] == after[e] || before[e] >= Groups) continue;
      sums[static_cast<std::size_t>(Counters::steps_of(before[e]))] +=
          static_cast<double>(step - from[e]);
      from[e] = step;
      times[e] = one_more(times[e]);
    }
    since.upload(from);
    switches.upload(times);
    counters.upload(sums);
  }
};

}  // namespace pliant
