#pragma once

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include <pliant/backend/patch_cuts.hpp>
#include <pliant/cuda/array.hpp>
#include <pliant/cuda/fan_plan.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/patch_plan.hpp>
#include <pliant/cuda/tuning.hpp>

// Patches are planned where they are used: a block plans one, in its shared memory.
namespace pliant::detail {

/// The patches of an element table.
template <class Planner>
struct PatchPlan {
  PatchCounts capacity;                       // of a patch; multiples of 4
  DeviceArray<typename Planner::Unit> units;  // (patches, Planner::units)
  DeviceArray<PatchNode> nodes;               // (patches, node capacity)
  DeviceArray<std::uint16_t> diagonals;       // (patches, diagonal capacity)
  DeviceArray<PatchCounts> counts;            // (patches): what each has
  PatchCounts
      changed{};  // the most that any needed where many were planned again; zero: they never were
};

inline constexpr int plan_threads = 512;

/// A block's threads as planners see them.
struct BlockThreads {
  __device__ int first() const { return static_cast<int>(threadIdx.x); }
  __device__ static constexpr int stride() { return plan_threads; }
  __device__ void meet() const { __syncthreads(); }
  __device__ bool any(bool value) const { return __syncthreads_or(value) != 0; }
};

/// The shared memory that planning patches of a size takes, bytes.
template <class Planner>
int plan_bytes(int patch_size) {
  PlanMemory memory;
  Planner const planner(memory, plan_threads, patch_size, 0);
  return memory.most();
}

/// Rows of a table's node numbers, cut into patches.
struct PatchInput {
  Index const* connectivity;  // (elements, width)
  int width, patch_size;
  Index const* first;  // (patches + 1), elements
};

/// Whether patches of such a capacity have room for so much.
PLIANT_HOST_DEVICE bool holds(PatchCounts const& capacity, PatchCounts const& counts) {
  return counts.nodes <= capacity.nodes && counts.diagonals <= capacity.diagonals &&
         counts.fans <= capacity.fans && counts.slots <= capacity.slots;
}

/// A plan as kernels see it.
template <class Planner>
struct PlanView {
  using Unit = typename Planner::Unit;
  PatchCounts capacity;
  Index const* first;  // (patches + 1), elements
  Unit* units;
  PatchNode* nodes;
  std::uint16_t* diagonals;
  PatchCounts* counts;

  __device__ Unit* units_of(Index patch) const {
    return units + Planner::first_unit(patch, first[patch], capacity);
  }
  __device__ PatchNode* nodes_of(Index patch) const {
    return nodes + static_cast<std::ptrdiff_t>(patch) * capacity.nodes;
  }
  __device__ std::uint16_t* diagonals_of(Index patch) const {
    return diagonals + static_cast<std::ptrdiff_t>(patch) * capacity.diagonals;
  }
  /// By one thread of a patch; the most of all into `most`.
  __device__ void set_counts(Index patch, PatchCounts const& own, PatchCounts* most) const {
    counts[patch] = own;
    atomicMax(&most->nodes, own.nodes);
    atomicMax(&most->diagonals, own.diagonals);
    atomicMax(&most->fans, own.fans);
    atomicMax(&most->slots, own.slots);
  }
};

/// By a block: counts what a patch has, the most of all into `most`, and plans it where there is room.
template <class Planner>
__device__ void plan_patch(PatchInput const& input, Index patch, PlanView<Planner> const& to,
                           PatchCounts* most) {
  extern __shared__ __align__(16) char planner_memory[];
  Index const first = input.first[patch];
  PlanMemory memory(planner_memory);
  Planner planner(memory, plan_threads, input.patch_size,
                  static_cast<int>(input.first[patch + 1] - first));
  auto const counts = planner.count(
      BlockThreads{}, input.connectivity + std::int64_t{first} * input.width, input.width);
  if (threadIdx.x == 0) to.set_counts(patch, counts, most);
  if (!holds(to.capacity, counts)) return;
  planner.plan(BlockThreads{}, to.capacity, to.units_of(patch), to.nodes_of(patch),
               to.diagonals_of(patch));
}

/// By a block: takes a patch from a plan, for which there is room.
template <class Planner>
__device__ void take_patch(PlanView<Planner> const& from, Index before, PlanView<Planner> const& to,
                           Index patch, PatchCounts* most) {
  PatchCounts const counts = from.counts[before];
  BlockThreads const threads;
  Planner::take(threads, counts, static_cast<int>(to.first[patch + 1] - to.first[patch]),
                from.capacity, from.units_of(before), to.capacity, to.units_of(patch));
  share_out(threads, to.capacity.nodes, [&](int n) {
    to.nodes_of(patch)[n] = n < counts.nodes ? from.nodes_of(before)[n] : PatchNode{};
  });
  share_out(threads, to.capacity.diagonals, [&](int d) {
    to.diagonals_of(patch)[d] = d < counts.diagonals ? from.diagonals_of(before)[d] : 0;
  });
  if (threadIdx.x == 0) to.set_counts(patch, counts, most);
}

/// Plans patches, or takes them from a plan of no larger capacity. known: (patches), the patch there; −1: none; null: all of
/// them are planned.
template <class Planner>
__global__ void __launch_bounds__(plan_threads)
    plan_patches_anew(PatchInput input, Index const* known, PlanView<Planner> from,
                      PlanView<Planner> to, PatchCounts* most) {
  auto const patch = static_cast<Index>(blockIdx.x);
  if (known != nullptr && known[patch] >= 0)
    take_patch(from, known[patch], to, patch, most);
  else
    plan_patch(input, patch, to, most);
}

/// Takes patches from a plan of theirs that had room for some of them, and plans the others.
template <class Planner>
__global__ void __launch_bounds__(plan_threads)
    plan_patches_left(PatchInput input, PlanView<Planner> from, PlanView<Planner> to,
                      PatchCounts* most) {
  auto const patch = static_cast<Index>(blockIdx.x);
  if (holds(from.capacity, from.counts[patch]))
    take_patch(from, patch, to, patch, most);
  else
    plan_patch(input, patch, to, most);
}

/// What a table was planned to before a change, with its patches as PatchRanges::first has them, and by the patch now the patch
/// there, or −1.
template <class Planner>
struct KnownPatches {
  PatchPlan<Planner> const* plan = nullptr;
  Index const* first = nullptr;
  std::vector<Index> patches{};
};

/// Whether many patches of a table are planned again.
template <class Planner>
bool many_change(KnownPatches<Planner> const& known) {
  auto const planned = std::ranges::count(known.patches, Index{-1});
  return known.plan != nullptr && 8 * planned >= std::ssize(known.patches);
}
/// The least multiples of four.
inline PatchCounts in_fours(PatchCounts const& counts) {
  auto const rounded = [](int n) { return (n + 3) / 4 * 4; };
  return {rounded(counts.nodes), rounded(counts.diagonals), rounded(counts.fans),
          rounded(counts.slots)};
}
inline PatchCounts larger(PatchCounts const& a, PatchCounts const& b) {
  return {std::max(a.nodes, b.nodes), std::max(a.diagonals, b.diagonals), std::max(a.fans, b.fans),
          std::max(a.slots, b.slots)};
}
/// What to give patches room for before it is known what they need: as much as before a change, where few are planned again;
/// else a little more than such patches ever needed, and at first as much as any needs, but for diagonals, so that few have to be
/// planned twice.
template <class Planner>
PatchCounts guessed_capacity(KnownPatches<Planner> const& known, int patch_size) {
  PatchCounts const usual = Planner::usual(patch_size);
  if (known.plan == nullptr) return usual;
  PatchCounts const& before = known.plan->capacity;
  if (!many_change(known)) return before;
  auto const& changed = known.plan->changed;
  auto guess = Planner::most(patch_size);
  if (changed.slots > 0) {
    auto const more = [](int n, int most) { return std::min(n + n / 32, most); };
    guess = in_fours({more(changed.nodes, guess.nodes), 0, more(changed.fans, guess.fans),
                      more(changed.slots, guess.slots)});
  }
  guess.diagonals = 2 * std::max(before.diagonals, usual.diagonals);
  return guess;
}

/// Waits for the device. There is no plan where `accepts` refuses the capacity that patches need. `known`: a plan of patches of
/// the same size: patches are planned while they are counted, or taken from there, with a capacity that may be right. Where it
/// is not, those that it has room for are taken from this first plan.
template <class Planner, class B, class Accepts>
PatchPlan<Planner> plan_patches(B const& backend, DeviceArray<Index> const& connectivity, int width,
                                PatchCuts const& cuts, Index const* first,
                                KnownPatches<Planner> const& known, Accepts const& accepts) {
  using View = PlanView<Planner>;
  PatchPlan<Planner> plan;
  Index const patches = cuts.count();
  if (patches == 0) return plan;
  DeviceGuard const device(backend.device());
  PatchInput const input{connectivity.data(), width, cuts.size(), first};
  auto most = backend.template array<PatchCounts>(1);
  auto const view = [](PatchPlan<Planner> const& of, Index const* first_of_patch) {
    return View{of.capacity,
                first_of_patch,
                const_cast<typename Planner::Unit*>(of.units.data()),
                const_cast<PatchNode*>(of.nodes.data()),
                const_cast<std::uint16_t*>(of.diagonals.data()),
                const_cast<PatchCounts*>(of.counts.data())};
  };
  auto const room_for = [&](PatchCounts const& capacity) {
    auto const for_each = [&](int n) {
      return static_cast<std::size_t>(patches) * static_cast<std::size_t>(n);
    };
    PatchPlan<Planner> room;
    room.capacity = capacity;
    if (capacity.nodes > 0)
      room.units = backend.template array<typename Planner::Unit>(
          static_cast<std::size_t>(Planner::first_unit(patches, cuts.first(patches), capacity)));
    room.nodes = backend.template array<PatchNode>(for_each(capacity.nodes));
    room.diagonals = backend.template array<std::uint16_t>(for_each(capacity.diagonals));
    room.counts = backend.template array<PatchCounts>(static_cast<std::size_t>(patches));
    return room;
  };
  LaunchShape const shape{patches, plan_threads, plan_bytes<Planner>(cuts.size())};

  PatchCounts const guess = guessed_capacity(known, cuts.size());
  plan = room_for(guess);
  View from{};
  DeviceArray<Index> patches_before;
  if (!known.patches.empty()) {
    from = view(*known.plan, known.first);
    patches_before = backend.array(std::span<Index const>(known.patches));
  }
  launch("plan patches", shape, backend.stream(), plan_patches_anew<Planner>, input,
         patches_before.data(), from, view(plan, first), most.data());
  PatchCounts counts;
  most.download({&counts, 1});
  auto const changed = known.plan == nullptr ? PatchCounts{}
                       : many_change(known)  ? larger(known.plan->changed, counts)
                                             : known.plan->changed;
  plan.changed = changed;
  // What a patch stages shares the memory of a multiprocessor with others: there is little room to spare.
  bool const is_right = holds(guess, counts) && guess.slots <= counts.slots + counts.slots / 16 &&
                        guess.nodes <= counts.nodes + counts.nodes / 16;
  if (is_right && accepts(guess)) return plan;
  auto const capacity = in_fours(counts);
  auto const guessed = std::exchange(plan, {});
  plan.capacity = capacity;
  if (!accepts(capacity)) return plan;
  plan = room_for(capacity);
  plan.changed = changed;
  launch("plan patches", shape, backend.stream(), plan_patches_left<Planner>, input,
         view(guessed, first), view(plan, first), most.data());
  return plan;
}

}  // namespace pliant::detail
