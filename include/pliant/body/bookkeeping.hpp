#pragma once

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
  static constexpr int count = Groups + 2 * Groups * Groups;
};

/// What is remembered of the elements of one type while they change groups; made when adaptation
/// first looks at them, so that other scenes do not pay.
template <Backend B, int Groups>
struct Bookkeeping {
  using Counters = CounterLayout<Groups>;

  typename B::template Array<Index> since;  // (elements): step of the last change of group
  typename B::template Array<std::uint16_t> switches;  // (elements): changes of group so far
  /// Element-steps per group of the stretches that are over (an element that leaves a group adds
  /// its steps there), moves and changes of strain energy (J) between groups.
  typename B::template Array<double> counters;
  bool open = false;

  void start(B const&, Index elements, long step) {
    auto const n = static_cast<std::size_t>(elements);
    since = typename B::template Array<Index>(n);
    since.upload(std::vector<Index>(n, static_cast<Index>(step)));
    switches = typename B::template Array<std::uint16_t>(n);
    counters = typename B::template Array<double>(Counters::count);
    open = true;
  }
};

}  // namespace pliant
