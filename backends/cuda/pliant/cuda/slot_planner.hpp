#pragma once

#include <cstdint>

#include <pliant/cuda/plan_threads.hpp>

namespace pliant::detail {

/// A node of a patch, and how many slots it has there.
struct PatchNode {
  Index node = -1;  // -1: none
  Index valence = 0;
};

/// What a patch has of each.
struct PatchCounts {
  int nodes = 0;
  int diagonals = 0;  // the valence of the node with most slots
  int fans = 0;
  int slots = 0;
};

/// Gives slots to the visits of a patch: each time that a thread has something for a node is a visit, and gets a slot
/// of its own. A patch's nodes are sorted by valence (the number of their slots), largest first, so that the k-th
/// slots of all nodes that have one lie side by side: node r's are diagonals[0] + r, diagonals[1] + r, ... (jagged
/// diagonals), which neighbouring threads read from neighbouring addresses without loading indices.
class SlotPlanner {
 public:
  static constexpr int lanes = 32;  // of a warp; also the banks of shared memory
  static constexpr std::uint16_t none = 0xffff;

  /// Of at most `units` threads' worth of work with `width` visits each, to at most `nodes` nodes.
  PLIANT_HOST_DEVICE SlotPlanner(PlanMemory& memory, int units, int width, int nodes)
      : width_(width),
        valence_(memory.take<int>(nodes)),
        rank_(memory.take<std::uint16_t>(nodes)),
        first_free_(memory.take<std::uint16_t>(nodes)),
        free_(memory.take<std::uint16_t>(units * width)),
        slot_(memory.take<std::uint16_t>(units * width)),
        lengths_(memory.take<std::uint16_t>(units * width + 1)),
        starts_(memory.take<std::uint16_t>(units * width)),
        writers_(memory.take<std::uint16_t>(lanes)),
        totals_(memory.take<int>(2)) {}

  /// local[units · width]: the node of each visit; none: there is no such visit. Adds to the nodes that are counted
  /// what these have of diagonals and slots.
  template <class Threads>
  PLIANT_HOST_DEVICE void count(Threads const& threads, std::uint16_t const* local, int units,
                                PatchCounts& counts) const {
    share_out(threads, counts.nodes, [&](int n) { valence_[n] = 0; });
    if (threads.first() == 0) totals_[0] = totals_[1] = 0;
    threads.meet();
    share_out(threads, units * width_, [&](int i) {
      if (local[i] != none) add_shared(valence_[local[i]], 1);
    });
    threads.meet();
    share_out(threads, counts.nodes, [&](int n) {
      raise_shared(totals_[0], valence_[n]);
      add_shared(totals_[1], valence_[n]);
    });
    threads.meet();
    counts.diagonals = totals_[0];
    counts.slots = totals_[1];
  }

  /// After `count`, a slot for each visit. To out_nodes and diagonals, for which there is room for `capacity`.
  template <class Threads>
  PLIANT_HOST_DEVICE void plan(Threads const& threads, std::uint16_t const* local, int units,
                               Index const* nodes, PatchCounts const& counts,
                               PatchCounts const& capacity, PatchNode* out_nodes,
                               std::uint16_t* diagonals) const {
    if (threads.first() == 0) sort_by_valence(counts);
    threads.meet();
    share_out(threads, capacity.nodes, [&](int n) {
      if (n >= counts.nodes) {
        out_nodes[n] = {};
        return;
      }
      out_nodes[rank_[n]] = {nodes[n], valence_[n]};
      for (int d = 0; d < valence_[n]; ++d)
        free_[first_free_[n] + d] = static_cast<std::uint16_t>(starts_[d] + rank_[n]);
    });
    share_out(threads, capacity.diagonals,
              [&](int d) { diagonals[d] = d < counts.diagonals ? starts_[d] : std::uint16_t{0}; });
    threads.meet();
    if (threads.first() == 0) assign_slots(local, units);
    threads.meet();
  }

  /// After `plan`: of a node, and of a visit.
  PLIANT_HOST_DEVICE std::uint16_t rank(int node) const { return rank_[node]; }
  PLIANT_HOST_DEVICE std::uint16_t slot(int visit) const { return slot_[visit]; }

 private:
  /// Ranks nodes by valence, those of one valence in their order; where each diagonal begins.
  PLIANT_HOST_DEVICE void sort_by_valence(PatchCounts const& counts) const {
    int const largest = counts.diagonals;
    for (int d = 0; d < largest; ++d) lengths_[d] = 0;
    for (int n = 0; n < counts.nodes; ++n) ++lengths_[valence_[n] - 1];
    // lengths_[v − 1]: of valence v; from here on the first rank of these, that is how many have a larger one.
    int larger = 0;
    for (int d = largest - 1; d >= 0; --d) {
      int const same = lengths_[d];
      lengths_[d] = static_cast<std::uint16_t>(larger);
      larger += same;
    }
    int free = 0;
    for (int n = 0; n < counts.nodes; ++n) {
      rank_[n] = lengths_[valence_[n] - 1]++;
      first_free_[n] = static_cast<std::uint16_t>(free);
      free += valence_[n];
    }
    // Now lengths_[d] is how many nodes have a d-th slot, and so the length of that diagonal.
    for (int d = 0, slot = 0; d < largest; ++d) {
      starts_[d] = static_cast<std::uint16_t>(slot);
      slot += lengths_[d];
    }
  }

  /// Any of a node's slots will do for any of its visits, so take one whose memory bank few threads of the warp write
  /// to at the same time.
  PLIANT_HOST_DEVICE void assign_slots(std::uint16_t const* local, int units) const {
    for (int begin = 0; begin < units; begin += lanes) {
      int const end = begin + lanes < units ? begin + lanes : units;
      for (int a = 0; a < width_; ++a) {
        for (int bank = 0; bank < lanes; ++bank) writers_[bank] = 0;
        for (int u = begin; u < end; ++u) {
          int const i = u * width_ + a, n = local[i];
          if (n == none) continue;
          std::uint16_t* const free = free_ + first_free_[n];
          int best = 0, least = writers_[free[0] % lanes];
          for (int k = 1; k < valence_[n] && least > 0; ++k) {
            int const writers = writers_[free[k] % lanes];
            if (writers < least) least = writers, best = k;
          }
          slot_[i] = free[best];
          ++writers_[slot_[i] % lanes];
          free[best] = free[--valence_[n]];
        }
      }
    }
  }

  int width_;
  int* valence_;  // (nodes): how many slots each has, from assign_slots on how many are free
  std::uint16_t *rank_, *first_free_;  // (nodes): by valence; in free_
  std::uint16_t* free_;                // (visits): slots that no visit has, by node
  std::uint16_t* slot_;                // (visits)
  std::uint16_t *lengths_, *starts_;   // (diagonals)
  std::uint16_t* writers_;             // (lanes): to each bank
  int* totals_;                        // diagonals, slots
};

}  // namespace pliant::detail
