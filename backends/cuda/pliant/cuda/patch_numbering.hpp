#pragma once

#include <bit>
#include <cstdint>

#include <pliant/cuda/plan_threads.hpp>

namespace pliant::detail {

/// Numbers the nodes of a patch, in the order in which its elements first have them.
template <int Nodes>
class PatchNumbering {
 public:
  PLIANT_HOST_DEVICE PatchNumbering(PlanMemory& memory, int patch_size)
      : mask_(static_cast<int>(std::bit_ceil(static_cast<unsigned>(patch_size * Nodes * 5 / 4))) -
              1),
        keys_(memory.take<Index>(mask_ + 1)),
        share_(memory.take<int>(mask_ + 1)),
        place_(memory.take<std::uint16_t>(patch_size * Nodes)) {}

  /// Of `size` elements, rows of `width` numbers that were checked before: local[share], for each share (an element's
  /// node), and the node that each of these is. How many there are; all threads have met then.
  template <class Threads>
  PLIANT_HOST_DEVICE int number(Threads const& threads, Index const* connectivity, int width,
                                int size, std::uint16_t* local, Index* nodes) const {
    int const shares = size * Nodes;
    auto const node = [&](int i) {
      return connectivity[std::int64_t{i / Nodes} * width + i % Nodes];
    };
    share_out(threads, mask_ + 1, [&](int i) {
      keys_[i] = -1;
      share_[i] = shares;
    });
    threads.meet();
    // Of an element at once where they are few, so that a device waits for its row once.
    constexpr int group = Nodes <= 4 ? Nodes : 1;
    share_out(threads, shares / group, [&](int g) {
      Index nodes_of[group];
      for (int k = 0; k < group; ++k) nodes_of[k] = node(group * g + k);
      for (int k = 0; k < group; ++k) {
        int const i = group * g + k, place = find_or_insert(keys_, mask_, nodes_of[k]);
        place_[i] = static_cast<std::uint16_t>(place);
        lower_shared(share_[place], i);
      }
    });
    threads.meet();
    // Each thread goes through a run of shares: how many of them have a node first, then the numbers of these.
    int const each = (shares + threads.stride() - 1) / threads.stride();
    auto const for_each_new = [&](auto const& f) {
      for (int i = threads.first() * each; i < (threads.first() + 1) * each && i < shares; ++i)
        if (share_[place_[i]] == i) f(i);
    };
    int count = 0, total = 0;
    for_each_new([&](int) { ++count; });
    int next = threads.sum_before(count, total);
    for_each_new([&](int i) {
      nodes[next] = keys_[place_[i]];
      local[i] = static_cast<std::uint16_t>(next++);
    });
    threads.meet();
    share_out(threads, shares, [&](int i) {
      int const first = share_[place_[i]];
      if (first != i) local[i] = local[first];
    });
    threads.meet();
    return total;
  }

 private:
  int mask_;
  Index* keys_;           // (table)
  int* share_;            // (table): the first that has the node
  std::uint16_t* place_;  // (shares): in the table
};

}  // namespace pliant::detail
