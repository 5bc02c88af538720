#pragma once

#include <bit>
#include <cstdint>

#include <pliant/config.hpp>

namespace pliant::detail {

/// Where an element finds its nodes in its patch, and where it puts their shares.
template <int Nodes>
struct alignas(16) PatchRow {
  static constexpr int width = (Nodes + 3) / 4 * 4;
  std::uint16_t local[width];  // which of the patch's nodes
  std::uint16_t slot[width];   // which place in the patch's staging memory
};

/// A node of a patch, and how many slots it has there.
struct PatchNode {
  Index node = -1;  // -1: none
  Index valence = 0;
};

/// The nodes of a patch, and the valence of that which has most slots.
struct PatchCounts {
  int nodes = 0;
  int diagonals = 0;
};

/// Plans a patch: a run of consecutive elements that one thread block works on. Every share that an element
/// has in a node gets a slot of its own. A patch's nodes are sorted by valence (the number of their
/// slots), largest first, so that the k-th slots of all nodes that have one lie side by side: node r's
/// are diagonals[0] + r, diagonals[1] + r, ... (jagged diagonals), which neighbouring threads read
/// from neighbouring addresses without loading indices.
///
/// Steps are called in the order of their declaration. Those with `first` and `stride` are shared by the threads of a
/// block, each with its own number and with their count, the others are for one thread; between two steps all
/// threads meet. A host calls all of them with 0 and 1.
template <int Nodes>
class PatchPlanner {
 public:
  static constexpr int lanes = 32;  // of a warp; also the banks of shared memory

  /// What a planner works in, bytes; aligned as Index is. Where it fits shared memory, 16 bits number all shares.
  static constexpr int bytes(int patch_size) {
    int const shares = patch_size * Nodes;
    return shares * int{2 * sizeof(Index) + 4 * sizeof(std::uint16_t)} +
           (table_size(shares) + lanes) * int{sizeof(std::uint16_t)};
  }

  /// For patches of at most `patch_size` elements, and one of `size`.
  PLIANT_HOST_DEVICE PatchPlanner(void* memory, int patch_size, int size)
      : size_(size), table_mask_(table_size(patch_size * Nodes) - 1) {
    int const shares = patch_size * Nodes;
    global_ = static_cast<Index*>(memory);
    node_ = global_ + shares;
    free_ = reinterpret_cast<std::uint16_t*>(global_);  // nobody asks for global numbers then
    slot_ = free_ + shares;
    valence_ = reinterpret_cast<std::uint16_t*>(node_ + shares);
    rank_ = valence_ + shares;
    first_free_ = rank_ + shares;
    local_ = first_free_ + shares;
    table_ = local_ + shares;
    writers_ = table_ + table_mask_ + 1;
    lengths_ = table_;  // nobody looks for nodes then
    starts_ = lengths_ + shares + 1;
  }

  /// Rows of `width` node numbers, which were checked before.
  PLIANT_HOST_DEVICE void read(Index const* connectivity, int width, int first, int stride) {
    for (int i = first; i < size_ * Nodes; i += stride)
      global_[i] = connectivity[std::int64_t{i / Nodes} * width + i % Nodes];
    for (int i = first; i <= table_mask_; i += stride) table_[i] = none;
  }

  /// Nodes in the order in which elements first have them.
  PLIANT_HOST_DEVICE PatchCounts number_nodes() {
    PatchCounts counts;
    for (int i = 0; i < size_ * Nodes; ++i) {
      Index const node = global_[i];
      unsigned at = static_cast<unsigned>(node) * 0x9E3779B1u >> 8;
      int local = none;
      while ((local = table_[at &= static_cast<unsigned>(table_mask_)]) != none &&
             node_[local] != node)
        ++at;
      if (local == none) {
        local = counts.nodes++;
        table_[at] = static_cast<std::uint16_t>(local);
        node_[local] = node;
        valence_[local] = 0;
      }
      local_[i] = static_cast<std::uint16_t>(local);
      int const valence = ++valence_[local];
      if (valence > counts.diagonals) counts.diagonals = valence;
    }
    return counts;
  }

  /// Ranks nodes by valence, those of one valence in their order; where each diagonal begins.
  PLIANT_HOST_DEVICE void sort_by_valence(PatchCounts const& counts) {
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

  /// To nodes[0 .. node_capacity) and diagonals[0 .. diagonal_capacity).
  PLIANT_HOST_DEVICE void write_nodes(PatchCounts const& counts, PatchNode* nodes,
                                      int node_capacity, std::uint16_t* diagonals,
                                      int diagonal_capacity, int first, int stride) {
    for (int n = first; n < node_capacity; n += stride) {
      if (n >= counts.nodes) {
        nodes[n] = {};
        continue;
      }
      nodes[rank_[n]] = {node_[n], valence_[n]};
      for (int d = 0; d < valence_[n]; ++d)
        free_[first_free_[n] + d] = static_cast<std::uint16_t>(starts_[d] + rank_[n]);
    }
    for (int d = first; d < diagonal_capacity; d += stride)
      diagonals[d] = d < counts.diagonals ? starts_[d] : std::uint16_t{0};
  }

  /// Any of a node's slots will do for any of its elements, so take one whose memory bank few threads of
  /// the warp write to at the same time.
  PLIANT_HOST_DEVICE void assign_slots() {
    for (int begin = 0; begin < size_; begin += lanes) {
      int const end = begin + lanes < size_ ? begin + lanes : size_;
      for (int a = 0; a < Nodes; ++a) {
        for (int bank = 0; bank < lanes; ++bank) writers_[bank] = 0;
        for (int e = begin; e < end; ++e) {
          int const i = e * Nodes + a, n = local_[i];
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

  PLIANT_HOST_DEVICE void write_rows(PatchRow<Nodes>* rows, int first, int stride) const {
    for (int e = first; e < size_; e += stride) {
      PatchRow<Nodes> row{};
      for (int a = 0; a < Nodes; ++a) {
        row.local[a] = rank_[local_[e * Nodes + a]];
        row.slot[a] = slot_[e * Nodes + a];
      }
      rows[e] = row;
    }
  }

 private:
  static constexpr std::uint16_t none = 0xffff;
  /// Of the table of nodes, which is never more than half full; what takes its place later fits too.
  static constexpr int table_size(int shares) {
    return 2 * static_cast<int>(std::bit_ceil(static_cast<unsigned>(shares) + 1));
  }

  int size_;  // elements
  int table_mask_;
  Index* global_;         // (shares): nodes of the elements
  Index* node_;           // (nodes)
  std::uint16_t* free_;   // (shares): slots that no element has, by node
  std::uint16_t* slot_;   // (shares)
  std::uint16_t* local_;  // (shares): which of the patch's nodes
  // (nodes): first how many slots each has, then how many are free; by valence; and in free_.
  std::uint16_t *valence_, *rank_, *first_free_;
  std::uint16_t* table_;              // of nodes, by a hash of their numbers
  std::uint16_t* writers_;            // (lanes): to each bank
  std::uint16_t *lengths_, *starts_;  // (diagonals)
};

}  // namespace pliant::detail
