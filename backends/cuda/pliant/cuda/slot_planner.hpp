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
        choices_(memory.take<std::uint16_t>(lanes)),
        banks_(memory.take<std::uint16_t>(lanes)),
        claims_(memory.take<int>(lanes)),
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
    sort_by_valence(threads, counts);
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
    if (threads.first() < threads.lanes()) assign_slots(threads, local, units);
    threads.meet();
  }

  /// After `plan`: of a node, and of a visit.
  PLIANT_HOST_DEVICE std::uint16_t rank(int node) const { return rank_[node]; }
  PLIANT_HOST_DEVICE std::uint16_t slot(int visit) const { return slot_[visit]; }

 private:
  /// Ranks nodes by valence, those of one valence in their order; where each diagonal begins. All threads have met then.
  template <class Threads>
  PLIANT_HOST_DEVICE void sort_by_valence(Threads const& threads, PatchCounts const& counts) const {
    // Threads read the valence of one node at a time, all the same one.
    share_out(threads, counts.nodes, [&](int n) {
      int const own = valence_[n];
      int rank = 0, free = 0;
      for (int m = 0; m < counts.nodes; ++m) {
        int const other = valence_[m];
        rank += other > own || (other == own && m < n) ? 1 : 0;
        free += m < n ? other : 0;
      }
      rank_[n] = static_cast<std::uint16_t>(rank);
      first_free_[n] = static_cast<std::uint16_t>(free);
    });
    // How many nodes have a d-th slot is the length of that diagonal.
    share_out(threads, counts.diagonals, [&](int d) {
      int length = 0;
      for (int m = 0; m < counts.nodes; ++m) length += valence_[m] > d ? 1 : 0;
      lengths_[d] = static_cast<std::uint16_t>(length);
    });
    threads.meet();
    if (threads.first() == 0)
      for (int d = 0, slot = 0; d < counts.diagonals; ++d) {
        starts_[d] = static_cast<std::uint16_t>(slot);
        slot += lengths_[d];
      }
    threads.meet();
  }

  /// Any of a node's slots will do for any of its visits, so take one whose memory bank few threads of the warp write to at
  /// the same time. The visits of a warp choose together: in rounds, of those that chose a bank the first one has it.
  template <class Threads>
  PLIANT_HOST_DEVICE void assign_slots(Threads const& threads, std::uint16_t const* local,
                                       int units) const {
    for (int begin = 0; begin < units; begin += lanes) {
      int const count = begin + lanes < units ? lanes : units - begin;
      auto const for_each_lane = [&](int n, auto const& f) {
        for (int l = threads.first(); l < n; l += threads.lanes()) f(l);
        threads.meet_lanes();
      };
      for (int a = 0; a < width_; ++a) {
        auto const visit = [&](int l) { return (begin + l) * width_ + a; };
        for_each_lane(lanes, [&](int l) {
          writers_[l] = 0;
          claims_[l] = lanes;
          choices_[l] = l >= count || local[visit(l)] == none ? none : std::uint16_t{0};
        });
        while (true) {
          bool some_left = false;
          for_each_lane(count, [&](int l) {
            if (choices_[l] == none) return;
            some_left = true;
            choices_[l] = choice(local[visit(l)]);
            banks_[l] = static_cast<std::uint16_t>(bank_of(local[visit(l)], choices_[l]));
            lower_shared(claims_[banks_[l]], l);
          });
          if (!threads.any(some_left)) break;
          for_each_lane(count, [&](int l) {
            if (choices_[l] == none) return;
            if (claims_[banks_[l]] != l) return;
            std::uint16_t& free = free_[first_free_[local[visit(l)]] + choices_[l]];
            slot_[visit(l)] = free;
            free = none;
            ++writers_[banks_[l]];
            choices_[l] = none;
          });
          for_each_lane(lanes, [&](int bank) { claims_[bank] = lanes; });
        }
      }
    }
  }
  /// The first of a node's free slots in a bank that is written to least.
  PLIANT_HOST_DEVICE std::uint16_t choice(int node) const {
    int best = 0, least = lanes + 1;
    for (int k = 0; k < valence_[node] && least > 0; ++k) {
      if (free_[first_free_[node] + k] == none) continue;
      int const writers = writers_[bank_of(node, k)];
      if (writers < least) least = writers, best = k;
    }
    return static_cast<std::uint16_t>(best);
  }
  PLIANT_HOST_DEVICE int bank_of(int node, int k) const {
    return free_[first_free_[node] + k] % lanes;
  }

  int width_;
  int* valence_;                       // (nodes): how many slots each has
  std::uint16_t *rank_, *first_free_;  // (nodes): by valence; in free_
  std::uint16_t* free_;                // (visits): slots, by node; none: a visit has it
  std::uint16_t* slot_;                // (visits)
  std::uint16_t *lengths_, *starts_;   // (diagonals)
  std::uint16_t* writers_;             // (lanes): to each bank
  std::uint16_t* choices_;  // (lanes): of a visit, among its node's slots; none: it has one
  std::uint16_t* banks_;    // (lanes): of these slots
  int* claims_;             // (lanes): the first visit that chose each bank
  int* totals_;             // diagonals, slots
};

}  // namespace pliant::detail
