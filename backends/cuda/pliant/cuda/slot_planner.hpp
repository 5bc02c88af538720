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
/// diagonals), which neighbouring threads read from neighbouring addresses without loading indices. The visits of a
/// batch choose together; threads of a block share it out.
template <int Batch>
class SlotPlanner {
 public:
  static constexpr int lanes = 32;  // of a warp; also the banks of shared memory
  static constexpr int batch = Batch;
  static constexpr std::uint16_t none = 0xffff;

  /// Of at most `units` threads' worth of work with `width` visits each, to at most `nodes` nodes.
  PLIANT_HOST_DEVICE SlotPlanner(PlanMemory& memory, int units, int width, int nodes)
      : width_(width),
        valence_(memory.take<int>(nodes)),
        rank_(memory.take<std::uint16_t>(nodes)),
        first_free_(memory.take<std::uint16_t>(nodes)),
        free_(memory.take<int>(units * width)),
        slot_(memory.take<std::uint16_t>(units * width)),
        starts_(memory.take<std::uint16_t>(units * width)),
        writers_(memory.take<std::uint16_t>(batch)),
        claims_(memory.take<int>(batch)),
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
        free_[first_free_[n] + d] = free_slot(starts_[d] + rank_[n]);
    });
    share_out(threads, capacity.diagonals,
              [&](int d) { diagonals[d] = d < counts.diagonals ? starts_[d] : std::uint16_t{0}; });
    threads.meet();
    assign_slots(threads, local, units);
  }

  /// After `plan`: of a node, and of a visit.
  PLIANT_HOST_DEVICE std::uint16_t rank(int node) const { return rank_[node]; }
  PLIANT_HOST_DEVICE std::uint16_t slot(int visit) const { return slot_[visit]; }

 private:
  /// Ranks nodes by valence, those of one valence in their order; where each diagonal begins. All threads have met then.
  template <class Threads>
  PLIANT_HOST_DEVICE void sort_by_valence(Threads const& threads, PatchCounts const& counts) const {
    int const nodes = counts.nodes;
    int* const ranks = free_;              // (nodes), until slots are free
    std::uint16_t* const by_rank = slot_;  // (nodes), until visits have slots: valences
    share_out(threads, nodes, [&](int n) { ranks[n] = 0; });
    // A run of nodes for each thread.
    int const each = (nodes + threads.stride() - 1) / threads.stride();
    auto const for_each_own = [&](auto const& f) {
      for (int n = threads.first() * each; n < (threads.first() + 1) * each && n < nodes; ++n) f(n);
    };
    int own_slots = 0, all_slots = 0;
    for_each_own([&](int n) { own_slots += valence_[n]; });
    int next = threads.sum_before(own_slots, all_slots);
    for_each_own([&](int n) {
      first_free_[n] = static_cast<std::uint16_t>(next);
      next += valence_[n];
    });
    threads.meet();
    // Several threads compare a node with all others. They read the valence of one of these at a time, all the same one.
    int const parts = nodes < threads.stride() ? threads.stride() / (nodes > 0 ? nodes : 1) : 1,
              part = (nodes + parts - 1) / parts;
    share_out(threads, nodes * parts, [&](int i) {
      int const n = i % nodes, own = valence_[n], begin = i / nodes * part,
                end = begin + part < nodes ? begin + part : nodes;
      int before = 0;
      for (int m = begin; m < end; ++m) {
        int const other = valence_[m];
        before += other > own || (other == own && m < n) ? 1 : 0;
      }
      add_shared(ranks[n], before);
    });
    threads.meet();
    share_out(threads, nodes, [&](int n) {
      rank_[n] = static_cast<std::uint16_t>(ranks[n]);
      by_rank[ranks[n]] = static_cast<std::uint16_t>(valence_[n]);
    });
    threads.meet();
    // How many nodes have a d-th slot is the length of that diagonal.
    share_out(threads, nodes, [&](int r) {
      for (int d = r + 1 < nodes ? by_rank[r + 1] : 0; d < by_rank[r]; ++d)
        starts_[d] = static_cast<std::uint16_t>(r + 1);
    });
    threads.meet();
    if (threads.first() == 0)
      for (int d = 0, slot = 0; d < counts.diagonals; ++d) {
        int const length = starts_[d];
        starts_[d] = static_cast<std::uint16_t>(slot);
        slot += length;
      }
    threads.meet();
  }

  /// A visit that looks for a slot among those of its node.
  struct Visit {
    int visit = -1;          // negative: it has one, or there is none
    int first, count;        // the node's in free_
    int begin;               // which of these it looks at first
    int chosen, slot, bank;  // in free_; there; in writers_
    bool has_bank, has_slot;
  };
  // Entries of free_: a slot, and above it which visit of the batch claims it; or:
  static constexpr int taken = -1, unclaimed = batch;
  PLIANT_HOST_DEVICE static constexpr int free_slot(int slot, int claim = unclaimed) {
    return claim << 16 | slot;
  }

  /// Any of a node's slots will do for any of its visits, so each takes one whose memory bank few threads of its warp write
  /// to at the same time. The visits of a batch of warps choose together, in rounds: one that is the first to choose a bank
  /// in its warp, and the first to choose the slot, has it. All threads have met then.
  template <class Threads>
  PLIANT_HOST_DEVICE void assign_slots(Threads const& threads, std::uint16_t const* local,
                                       int units) const {
    static_assert(batch % Threads::stride() == 0);
    constexpr int own = batch / Threads::stride();
    int const warps = (units + lanes - 1) / lanes * width_;  // with the same visit each of 32 units
    for (int begin = 0; begin < warps; begin += batch / lanes) {
      Visit visits[own];
      auto const for_each = [&](auto const& f) {
        for (int k = 0; k < own; ++k) f(visits[k], threads.first() + k * Threads::stride());
      };
      auto const for_each_left = [&](auto const& f) {
        for_each([&](Visit& v, int i) {
          if (v.visit >= 0) f(v, i);
        });
      };
      for_each([&](Visit& v, int i) {
        writers_[i] = 0;
        claims_[i] = batch;
        int const warp = begin + i / lanes, unit = warp / width_ * lanes + i % lanes;
        if (warp >= warps || unit >= units) return;
        int const visit = unit * width_ + warp % width_, node = local[visit];
        if (node == none) return;
        v.visit = visit;
        v.first = first_free_[node];
        v.count = valence_[node];
        v.begin = v.first + i / lanes % v.count;  // visits of a node begin with others each
      });
      threads.meet();
      for (bool some_left = true; some_left;) {
        for_each_left([&](Visit& v, int i) { choose(v, i / lanes * lanes); });
        threads.meet();
        for_each_left([&](Visit const& v, int i) {
          lower_shared(claims_[v.bank], i);
          lower_shared(free_[v.chosen], free_slot(v.slot, i));
        });
        threads.meet();
        for_each_left([&](Visit& v, int i) {
          v.has_bank = claims_[v.bank] == i;
          v.has_slot = free_[v.chosen] >> 16 == i;
        });
        threads.meet();
        bool left = false;
        for_each_left([&](Visit& v, int) {
          bool const has_both = v.has_bank && v.has_slot;
          if (v.has_bank) claims_[v.bank] = batch;
          if (v.has_slot) free_[v.chosen] = has_both ? taken : free_slot(v.slot);
          if (has_both) {
            ++writers_[v.bank];
            slot_[v.visit] = static_cast<std::uint16_t>(v.slot);
            v.visit = -1;
          } else {
            left = true;
          }
        });
        some_left = threads.any(left);
      }
    }
  }
  /// The next of a node's free slots in a bank that the warp writes to least. `banks`: where these begin.
  PLIANT_HOST_DEVICE void choose(Visit& v, int banks) const {
    int least = lanes + 1;
    for (int left = v.count, k = v.begin; left > 0 && least > 0; --left, ++k) {
      if (k == v.first + v.count) k = v.first;
      if (free_[k] == taken) continue;
      int const slot = free_[k] & 0xffff, bank = banks + slot % lanes;
      if (writers_[bank] >= least) continue;
      least = writers_[bank];
      v.chosen = k;
      v.slot = slot;
      v.bank = bank;
    }
  }

  int width_;
  int* valence_;                       // (nodes): how many slots each has
  std::uint16_t *rank_, *first_free_;  // (nodes): by valence; in free_
  int* free_;                          // (visits): slots, by node
  std::uint16_t *slot_, *starts_;      // (visits); (diagonals)
  std::uint16_t* writers_;             // (batch): to each bank, by the warp
  int* claims_;                        // (batch): the first visit that chose the bank
  int* totals_;                        // diagonals, slots
};

}  // namespace pliant::detail
