#pragma once

#include <pliant/cuda/fan_splitter.hpp>
#include <pliant/cuda/patch_numbering.hpp>
#include <pliant/cuda/slot_planner.hpp>

namespace pliant::detail {

/// A node of a patch that a fan visits, the slot for what it adds there, and an element of the fan: in the order of the
/// patch. A fan visits the ends of its edge first, which have no element but the fan's size in the first one's place;
/// then the nodes around the edge: two for its first element, of which the later has it, and another one for each
/// further element. Around a closed fan, the last visit is to the first of these nodes and its slot again.
struct FanVisit {
  std::uint32_t bits = 0;

  PLIANT_HOST_DEVICE static FanVisit of(int node, int slot, int element) {
    return {static_cast<std::uint32_t>(node) | static_cast<std::uint32_t>(slot) << 10 |
            static_cast<std::uint32_t>(element) << 22};
  }
  PLIANT_HOST_DEVICE int node() const { return static_cast<int>(bits & 1023); }
  PLIANT_HOST_DEVICE int slot() const { return static_cast<int>(bits >> 10 & 4095); }
  PLIANT_HOST_DEVICE int element() const { return static_cast<int>(bits >> 22); }
};

/// The most visits of a fan, and of one around a whole edge the last.
inline constexpr int most_fan_visits = most_fan_elements + 3;

/// Plans a patch of tetrahedra that one thread block works on, a fan in a thread. Each visit of a fan gets a slot.
class FanPlanner {
 public:
  static constexpr int nodes = 4;
  /// Of a block on a GPU: as many as most patches have elements, so that none takes two.
  static constexpr int block_threads = 768;
  using Unit = FanVisit;  // of a plan
  /// Where the units of a patch begin, of which the first element is given.
  PLIANT_HOST_DEVICE static std::ptrdiff_t first_unit(Index patch, Index /* first_element */,
                                                      PatchCounts const& capacity) {
    return static_cast<std::ptrdiff_t>(patch) * (most_fan_visits * capacity.fans);
  }

  /// What patches of a size have in most meshes, at most.
  static PatchCounts usual(int patch_size) {
    return {patch_size / 2, 32, patch_size / 3, 2 * patch_size};
  }

  /// What any patch has at most; of diagonals nothing is said.
  static PatchCounts most(int patch_size) {
    return {FanSplitter::most_nodes, 0, patch_size, nodes * patch_size};
  }

  /// For patches of at most `patch_size` elements, FanSplitter::most_elements or fewer, and one of `size`.
  PLIANT_HOST_DEVICE FanPlanner(PlanMemory& memory, int patch_size, int size)
      : size_(size),
        nodes_(memory.take<Index>(nodes * patch_size)),
        local_(memory.take<std::uint16_t>(nodes * patch_size)),
        visits_(memory.take<std::uint16_t>(most_fan_visits * patch_size)),
        begin_(memory.used()),
        numbering_(memory, patch_size),
        splitter_(memory.from(begin_), patch_size),
        slots_(memory.from(splitter_.end()), patch_size, most_fan_visits, FanSplitter::most_nodes) {
  }

  /// Rows of `width` node numbers, which were checked before. A patch with more than FanSplitter::most_nodes has no
  /// plan, and nothing else is counted.
  template <class Threads>
  PLIANT_HOST_DEVICE PatchCounts count(Threads const& threads, Index const* connectivity,
                                       int width) {
    counts_.nodes = numbering_.number(threads, connectivity, width, size_, local_, nodes_);
    if (counts_.nodes > FanSplitter::most_nodes) return counts_;
    counts_.fans = splitter_.split(threads, local_, size_);
    share_out(threads, counts_.fans * most_fan_visits,
              [&](int i) { visits_[i] = static_cast<std::uint16_t>(node(i)); });
    threads.meet();
    slots_.count(threads, visits_, counts_.fans, counts_);
    return counts_;
  }

  /// After `count`, where there is room for `capacity`: to visits[(visit, fan)], nodes and diagonals.
  template <class Threads>
  PLIANT_HOST_DEVICE void plan(Threads const& threads, PatchCounts const& capacity,
                               FanVisit* visits, PatchNode* patch_nodes,
                               std::uint16_t* diagonals) const {
    slots_.plan(threads, visits_, counts_.fans, nodes_, counts_, capacity, patch_nodes, diagonals);
    share_out(threads, capacity.fans, [&](int f) {
      for (int j = 0; j < most_fan_visits; ++j)
        visits[j * capacity.fans + f] = f < counts_.fans ? visit(f, j) : FanVisit{};
    });
  }

  /// The visits of a patch that has a plan of another capacity.
  template <class Threads>
  PLIANT_HOST_DEVICE static void take(Threads const& threads, PatchCounts const& own,
                                      int /* size */, PatchCounts const& from,
                                      FanVisit const* known, PatchCounts const& capacity,
                                      FanVisit* visits) {
    share_out(threads, capacity.fans, [&](int f) {
      FanVisit of_fan[most_fan_visits];  // read before any is written, so that a device waits once
      for (int j = 0; j < most_fan_visits; ++j)
        of_fan[j] = f < own.fans ? known[j * from.fans + f] : FanVisit{};
      for (int j = 0; j < most_fan_visits; ++j) visits[j * capacity.fans + f] = of_fan[j];
    });
  }

 private:
  using Slots = SlotPlanner<block_threads>;

  /// Of the i-th visit of all, without that which closes a fan.
  PLIANT_HOST_DEVICE int node(int i) const {
    int const f = i / most_fan_visits, j = i % most_fan_visits, size = splitter_.size(f);
    if (j < 3) return splitter_.corner(splitter_.member(f, 0), j);
    if (j - 3 >= size) return Slots::none;
    int const end = splitter_.corner(splitter_.member(f, j - 3), 3);
    bool const closes = j - 2 == size && end == splitter_.corner(splitter_.member(f, 0), 2);
    return closes ? Slots::none : end;
  }
  PLIANT_HOST_DEVICE FanVisit visit(int f, int j) const {
    int const size = splitter_.size(f), element = j == 0  ? size
                                                  : j < 3 ? 0
                                                          : splitter_.member(f, j - 3).element();
    if (j - 3 >= size) return {};
    int i = f * most_fan_visits + j;
    if (visits_[i] == Slots::none) i = f * most_fan_visits + 2;  // closes the fan
    return FanVisit::of(slots_.rank(visits_[i]), slots_.slot(i), element);
  }

  int size_;               // elements
  Index* nodes_;           // (nodes)
  std::uint16_t* local_;   // (elements, 4): which of these
  std::uint16_t* visits_;  // (fans, most_fan_visits)
  int begin_;              // of what the others work in
  PatchNumbering<nodes> numbering_;
  FanSplitter splitter_;
  Slots slots_;
  PatchCounts counts_;
};

}  // namespace pliant::detail
