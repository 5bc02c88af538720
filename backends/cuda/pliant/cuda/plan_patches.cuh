#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/patch_cuts.hpp>
#include <pliant/cuda/array.hpp>
#include <pliant/cuda/known_patches.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/side_stream.hpp>
#include <pliant/cuda/tuning.hpp>

// Patches are planned where they are used: a block plans one, in its shared memory.
namespace pliant::detail {

/// The threads of a block, as a planner sees them.
template <int Threads>
struct BlockThreads {
  __device__ int first() const { return static_cast<int>(threadIdx.x); }
  __device__ static constexpr int stride() { return Threads; }
  __device__ void meet() const { __syncthreads(); }
  __device__ bool any(bool value) const { return __syncthreads_or(value) != 0; }
  template <class U>
  __device__ U sum_before(U own, U& all) const {
    constexpr int warps = stride() / warp_size;
    static_assert(stride() % warp_size == 0 && warps <= warp_size);
    __shared__ U of_warps[warps];
    int const lane = first() % warp_size, warp = first() / warp_size;
    auto const sum_to = [&](U sum) {
      for (int step = 1; step < warp_size; step *= 2) {
        U const before = __shfl_up_sync(0xffffffffu, sum, step);
        if (lane >= step) sum += before;
      }
      return sum;
    };
    U const sum = sum_to(own);
    if (lane == warp_size - 1) of_warps[warp] = sum;
    meet();
    U const sums = sum_to(lane < warps ? of_warps[lane] : U{});
    all = __shfl_sync(0xffffffffu, sums, warps - 1);
    U const before = __shfl_sync(0xffffffffu, sums, warp > 0 ? warp - 1 : 0);
    meet();
    return sum - own + (warp > 0 ? before : U{});
  }
};

/// The shared memory that planning patches of a size takes, bytes.
template <class Planner>
int plan_bytes(int patch_size) {
  PlanMemory memory;
  Planner const planner(memory, patch_size, 0);
  return memory.most();
}

/// Rows of a table's node numbers, cut into patches.
struct PatchInput {
  Index const* connectivity;  // (elements, width)
  int width, patch_size;
  Index const* first;  // (patches + 1), elements
};

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
  BlockThreads<Planner::block_threads> const threads;
  Planner planner(memory, input.patch_size, static_cast<int>(input.first[patch + 1] - first));
  auto const counts =
      planner.count(threads, input.connectivity + std::int64_t{first} * input.width, input.width);
  if (threadIdx.x == 0) to.set_counts(patch, counts, most);
  if (!holds(to.capacity, counts)) return;
  planner.plan(threads, to.capacity, to.units_of(patch), to.nodes_of(patch),
               to.diagonals_of(patch));
}

/// By a block of so many threads: takes a patch from a plan, for which there is room.
template <int Threads, class Planner>
__device__ void take_patch(PlanView<Planner> const& from, Index before, PlanView<Planner> const& to,
                           Index patch, PatchCounts* most) {
  PatchCounts const counts = from.counts[before];
  BlockThreads<Threads> const threads;
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

/// Plans patches: those of a list, or all, where it is null. May run beside take_known_patches, and ends behind that.
template <class Planner>
__global__ void __launch_bounds__(Planner::block_threads)
    plan_listed_patches(PatchInput input, Index const* list, PlanView<Planner> to,
                        PatchCounts* most) {
  auto const i = static_cast<Index>(blockIdx.x);
  plan_patch(input, list == nullptr ? i : list[i], to, most);
  end_after_previous_kernel();
}

/// Takes patches from a plan of no larger capacity. known: (patches), the patch there; −1: none.
template <class Planner>
__global__ void __launch_bounds__(take_threads)
    take_known_patches(Index const* known, PlanView<Planner> from, PlanView<Planner> to,
                       PatchCounts* most) {
  begin_after_previous_kernel();
  auto const patch = static_cast<Index>(blockIdx.x);
  if (known[patch] >= 0) take_patch<take_threads>(from, known[patch], to, patch, most);
}

/// Takes patches from a plan of theirs that had room for some of them, and plans the others.
template <class Planner>
__global__ void __launch_bounds__(Planner::block_threads)
    plan_patches_left(PatchInput input, PlanView<Planner> from, PlanView<Planner> to,
                      PatchCounts* most) {
  auto const patch = static_cast<Index>(blockIdx.x);
  if (holds(from.capacity, from.counts[patch]))
    take_patch<Planner::block_threads>(from, patch, to, patch, most);
  else
    plan_patch(input, patch, to, most);
}

template <class Planner>
PlanView<Planner> view_of(PatchPlan<Planner> const& plan, Index const* first) {
  return {plan.capacity,
          first,
          const_cast<typename Planner::Unit*>(plan.units.data()),
          const_cast<PatchNode*>(plan.nodes.data()),
          const_cast<std::uint16_t*>(plan.diagonals.data()),
          const_cast<PatchCounts*>(plan.counts.data())};
}

/// A plan without values, which has room for patches of such a capacity.
template <class Planner, class B>
PatchPlan<Planner> room_for_plan(B const& backend, PatchCuts const& cuts,
                                 PatchCounts const& capacity) {
  Index const patches = cuts.count();
  auto const for_each = [&](int n) {
    return static_cast<std::size_t>(patches) * static_cast<std::size_t>(n);
  };
  PatchPlan<Planner> room;
  room.capacity = capacity;
  if (capacity.nodes > 0)
    room.units = backend.template unset_array<typename Planner::Unit>(
        static_cast<std::size_t>(Planner::first_unit(patches, cuts.first(patches), capacity)));
  room.nodes = backend.template unset_array<PatchNode>(for_each(capacity.nodes));
  room.diagonals = backend.template unset_array<std::uint16_t>(for_each(capacity.diagonals));
  room.counts = backend.template unset_array<PatchCounts>(static_cast<std::size_t>(patches));
  return room;
}

template <class Planner>
LaunchShape plan_shape(Index patches, PatchCuts const& cuts) {
  return {patches, Planner::block_threads, plan_bytes<Planner>(cuts.size())};
}

/// Known patches, and behind them a list of those that are not.
template <class Planner>
std::vector<Index> known_and_planned(KnownPatches<Planner> const& known) {
  auto lists = known.patches;
  for (Index p = 0; p < static_cast<Index>(known.patches.size()); ++p)
    if (known.patches[static_cast<std::size_t>(p)] < 0) lists.push_back(p);
  return lists;
}

/// Patches that are being planned.
template <class Planner>
struct PlanInWork {
  PatchInput input;
  PatchPlan<Planner> plan;  // of a capacity that may be right
  LastNeeds needs;          // of the plan before
  bool changes_many, leaves_fewer;
  DeviceArray<Index> known_and_planned;  // (patches), as KnownPatches::patches; and those of −1
  DeviceArray<PatchCounts> most;         // that any patch needs
};

/// Begins to plan patches, as a piece of work on a side stream if there is one; what any needs goes there to its mail. `known`: a
/// plan of patches of the same size: patches are planned while they are counted, or taken from there, which has to stay until that
/// is done.
template <class Planner, class B>
PlanInWork<Planner> begin_plan(B const& backend, PatchInput const& input, PatchCuts const& cuts,
                               KnownPatches<Planner> const& known, SideWork const* side = nullptr) {
  DeviceGuard const device(backend.device());
  bool const is_known = !known.patches.empty();
  auto const lists = known_and_planned(known);
  PlanInWork<Planner> work{
      input,
      room_for_plan<Planner>(backend, cuts, guessed_capacity(known, cuts.size())),
      known.plan == nullptr ? LastNeeds{} : known.plan->needs,
      many_change(known),
      leaves_fewer(known),
      is_known ? backend.array(std::span<Index const>(lists)) : DeviceArray<Index>{},
      backend.template array<PatchCounts>(1)};
  auto const to = view_of(work.plan, input.first);
  auto const stream = side ? side->stream().begin() : backend.stream();
  Index const* const first_known = work.known_and_planned.data();
  auto const planned = is_known ? static_cast<Index>(lists.size()) - cuts.count() : cuts.count();
  bool const takes = planned < cuts.count();
  if (takes)
    launch("plan patches", {cuts.count(), take_threads}, stream, take_known_patches<Planner>,
           first_known, view_of(*known.plan, known.first), to, work.most.data());
  if (planned > 0)
    launch(takes ? Start::early : Start::in_order, "plan patches",
           plan_shape<Planner>(planned, cuts), stream, plan_listed_patches<Planner>, input,
           is_known ? first_known + cuts.count() : nullptr, to, work.most.data());
  if (side)
    check(cudaMemcpyAsync(side->mail(), work.most.data(), sizeof(PatchCounts),
                          cudaMemcpyDeviceToHost, stream),
          "cudaMemcpyAsync");
  return work;
}

/// Ends it; `counts`: what is in work.most when that is done. There is no plan where `accepts` refuses the capacity that patches
/// need. Where that of the work is not right, those that it has room for are taken from it.
template <class Planner, class B, class Accepts>
PatchPlan<Planner> end_plan(B const& backend, PlanInWork<Planner> work, PatchCounts const& counts,
                            PatchCuts const& cuts, Accepts const& accepts) {
  DeviceGuard const device(backend.device());
  if (work.changes_many) work.needs.note(work.leaves_fewer, counts);
  auto const needs = work.needs;
  PatchCounts const guess = work.plan.capacity;
  PatchPlan<Planner> plan;
  if (may_keep(guess, counts) && accepts(guess)) {
    plan = std::move(work.plan);
  } else {
    plan.capacity = in_fours(counts);
    if (!accepts(plan.capacity)) return plan;
    plan = room_for_plan<Planner>(backend, cuts, plan.capacity);
    launch("plan patches", plan_shape<Planner>(cuts.count(), cuts), backend.stream(),
           plan_patches_left<Planner>, work.input, view_of(work.plan, work.input.first),
           view_of(plan, work.input.first), work.most.data());
  }
  plan.needs = needs;
  return plan;
}

/// Both; waits for the device.
template <class Planner, class B, class Accepts>
PatchPlan<Planner> plan_patches(B const& backend, PatchInput const& input, PatchCuts const& cuts,
                                KnownPatches<Planner> const& known, Accepts const& accepts) {
  if (cuts.count() == 0) return {};
  auto work = begin_plan(backend, input, cuts, known);
  PatchCounts counts;
  work.most.download({&counts, 1});
  return end_plan(backend, std::move(work), counts, cuts, accepts);
}

}  // namespace pliant::detail
