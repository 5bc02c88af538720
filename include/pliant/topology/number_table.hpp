#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <pliant/config.hpp>

namespace pliant {

/// Numbers from 0 on for groups of N nodes, in the order in which they come. A hash table in one array of which no more
/// than half is taken: a group lies beside others with the same last node, as those that come next often have, or where
/// its hash says when it is crowded there.
template <std::size_t N>
class NumberTable {
 public:
  using Nodes = std::array<Index, N>;

  /// The number of a group, and whether it is new. Groups in another order of their nodes are others; the last node is
  /// not negative.
  std::pair<Index, bool> find_or_add(Nodes const& nodes) {
    if (2 * static_cast<std::size_t>(count_ + 1) > entries_.size()) grow();
    Entry& entry = entries_[place_of(nodes)];
    bool const is_new = entry.number < 0;
    if (is_new) entry = {nodes, count_++};
    return {entry.number, is_new};
  }
  /// Gives the memory back.
  void clear() { *this = {}; }

 private:
  struct Entry {
    Nodes nodes{};
    Index number = -1;
  };

  static constexpr std::size_t beside = 8 * N,
                               near = 4;  // places per last node, and those that are tried

  /// Where a group is, or would be.
  [[nodiscard]] std::size_t place_of(Nodes const& nodes) const {
    std::uint64_t hash = 0;
    for (Index node : nodes) {
      hash = (hash ^ static_cast<std::uint32_t>(node)) * 0x9e3779b97f4a7c15;
      hash ^= hash >> 32;
    }
    std::size_t const mask = entries_.size() - 1;
    auto const fits = [&](std::size_t place) {
      Entry const& entry = entries_[place];
      if (entry.number < 0) return true;
      for (std::size_t k = N; k-- > 0;)
        if (entry.nodes[k] != nodes[k]) return false;
      return true;
    };
    auto const home = beside * static_cast<std::size_t>(nodes.back()) + hash % beside;
    for (std::size_t k = 0; k < near; ++k)
      if (fits((home + k) & mask)) return (home + k) & mask;
    auto place = static_cast<std::size_t>(hash >> 16) & mask;
    while (!fits(place)) place = (place + 1) & mask;
    return place;
  }
  void grow() {
    std::vector<Entry> const old =
        std::exchange(entries_, std::vector<Entry>(entries_.empty() ? 64 : 4 * entries_.size()));
    for (Entry const& entry : old)
      if (entry.number >= 0) entries_[place_of(entry.nodes)] = entry;
  }

  std::vector<Entry> entries_;  // a power of two
  Index count_ = 0;
};

}  // namespace pliant
