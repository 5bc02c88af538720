#pragma once

#include <cstdint>

#include <pliant/cuda/patch_numbering.hpp>
#include <pliant/cuda/slot_planner.hpp>

namespace pliant::detail {

/// Where an element finds its nodes in its patch, and where it puts their shares.
template <int Nodes>
struct alignas(16) PatchRow {
  static constexpr int width = (Nodes + 3) / 4 * 4;
  std::uint16_t local[width];  // which of the patch's nodes
  std::uint16_t slot[width];   // which place in the patch's staging memory
};

/// Plans a patch: a run of consecutive elements that one thread block works on, an element in a thread. Every share
/// that an element has in a node gets a slot of its own.
template <int Nodes>
class PatchPlanner {
 public:
  static constexpr int nodes = Nodes;
  static constexpr int block_threads = 512;  // of a block on a GPU
  using Unit = PatchRow<Nodes>;              // of a plan
  /// Where the units of a patch begin, of which the first element is given.
  PLIANT_HOST_DEVICE static std::ptrdiff_t first_unit(Index /* patch */, Index first_element,
                                                      PatchCounts const&) {
    return first_element;
  }

  /// What patches of a size have in most meshes, at most.
  static PatchCounts usual(int patch_size) {
    return {patch_size * (Nodes > 4 ? 2 : 1), 32, 0, Nodes * patch_size};
  }

  /// What any patch has at most; of diagonals nothing is said.
  static PatchCounts most(int patch_size) { return {Nodes * patch_size, 0, 0, Nodes * patch_size}; }

  /// For patches of at most `patch_size` elements, and one of `size`.
  PLIANT_HOST_DEVICE PatchPlanner(PlanMemory& memory, int patch_size, int size)
      : size_(size),
        local_(memory.take<std::uint16_t>(patch_size * Nodes)),
        nodes_(memory.take<Index>(patch_size * Nodes)),
        begin_(memory.used()),
        numbering_(memory, patch_size),
        slots_(memory.from(begin_), patch_size, Nodes, patch_size * Nodes) {}

  /// Rows of `width` node numbers, which were checked before.
  template <class Threads>
  PLIANT_HOST_DEVICE PatchCounts count(Threads const& threads, Index const* connectivity,
                                       int width) {
    counts_.nodes = numbering_.number(threads, connectivity, width, size_, local_, nodes_);
    slots_.count(threads, local_, size_, counts_);
    return counts_;
  }

  /// After `count`, where there is room for `capacity`: to rows[0 .. size), nodes and diagonals.
  template <class Threads>
  PLIANT_HOST_DEVICE void plan(Threads const& threads, PatchCounts const& capacity,
                               PatchRow<Nodes>* rows, PatchNode* patch_nodes,
                               std::uint16_t* diagonals) const {
    slots_.plan(threads, local_, size_, nodes_, counts_, capacity, patch_nodes, diagonals);
    share_out(threads, size_, [&](int e) {
      PatchRow<Nodes> row{};
      for (int a = 0; a < Nodes; ++a) {
        row.local[a] = slots_.rank(local_[e * Nodes + a]);
        row.slot[a] = slots_.slot(e * Nodes + a);
      }
      rows[e] = row;
    });
  }

  /// The rows of a patch of `size` elements that has a plan of another capacity.
  template <class Threads>
  PLIANT_HOST_DEVICE static void take(Threads const& threads, PatchCounts const& /* own */,
                                      int size, PatchCounts const& /* from */,
                                      PatchRow<Nodes> const* known,
                                      PatchCounts const& /* capacity */, PatchRow<Nodes>* rows) {
    share_out(threads, size, [&](int e) { rows[e] = known[e]; });
  }

 private:
  int size_;              // elements
  std::uint16_t* local_;  // (shares): which of the patch's nodes
  Index* nodes_;          // (nodes)
  int begin_;             // of what the following two work in, one after the other
  PatchNumbering<Nodes> numbering_;
  SlotPlanner<block_threads> slots_;
  PatchCounts counts_;
};

}  // namespace pliant::detail
