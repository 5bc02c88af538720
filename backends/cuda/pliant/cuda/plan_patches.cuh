#pragma once

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
};

inline constexpr int plan_threads = 128;

/// A block's threads as planners see them.
struct BlockThreads {
  __device__ int first() const { return static_cast<int>(threadIdx.x); }
  __device__ int stride() const { return plan_threads; }
  __device__ void meet() const { __syncthreads(); }
  __device__ int lanes() const { return warp_size; }
  __device__ void meet_lanes() const { __syncwarp(); }
  __device__ bool any(bool value) const { return __any_sync(0xffffffffu, value) != 0; }
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
  Index count;                // elements
  Index const* connectivity;  // (elements, width)
  int width, patch_size;

  __device__ int size(Index first) const {
    return static_cast<int>(min(count - first, static_cast<Index>(patch_size)));
  }
};

/// Whether patches of such a capacity have room for so much.
PLIANT_HOST_DEVICE bool holds(PatchCounts const& capacity, PatchCounts const& counts) {
  return counts.nodes <= capacity.nodes && counts.diagonals <= capacity.diagonals &&
         counts.fans <= capacity.fans && counts.slots <= capacity.slots;
}

/// Counts what each patch has, the most of it into `most`, and plans the patch where there is room for it.
template <class Planner>
__global__ void __launch_bounds__(plan_threads)
    plan_each_patch(PatchInput input, PatchCounts capacity, typename Planner::Unit* units,
                    PatchNode* nodes, std::uint16_t* diagonals, PatchCounts* most) {
  extern __shared__ __align__(16) char planner_memory[];
  Index const first = static_cast<Index>(blockIdx.x) * input.patch_size;
  PlanMemory memory(planner_memory);
  Planner planner(memory, plan_threads, input.patch_size, input.size(first));
  auto const counts = planner.count(
      BlockThreads{}, input.connectivity + std::int64_t{first} * input.width, input.width);
  if (threadIdx.x == 0) {
    atomicMax(&most->nodes, counts.nodes);
    atomicMax(&most->diagonals, counts.diagonals);
    atomicMax(&most->fans, counts.fans);
    atomicMax(&most->slots, counts.slots);
  }
  if (!holds(capacity, counts)) return;
  auto const patch = static_cast<std::int64_t>(blockIdx.x);
  planner.plan(BlockThreads{}, capacity, units + patch * Planner::units(input.patch_size, capacity),
               nodes + patch * capacity.nodes, diagonals + patch * capacity.diagonals);
}

/// Waits for the device. There is no plan where `accepts` refuses the capacity that patches need. `guess`: a capacity that may
/// be right, as that before a change, so that most patches are planned while they are counted; else none.
template <class Planner, class B, class Accepts>
PatchPlan<Planner> plan_patches(B const& backend, DeviceArray<Index> const& connectivity,
                                Index count, int width, int patch_size, PatchCounts const& guess,
                                Accepts const& accepts) {
  PatchPlan<Planner> plan;
  if (count == 0) return plan;
  DeviceGuard const device(backend.device());
  PatchInput const input{count, connectivity.data(), width, patch_size};
  Index const patches = (count - 1) / patch_size + 1;
  LaunchShape const shape{patches, plan_threads, plan_bytes<Planner>(patch_size)};
  auto most = backend.template array<PatchCounts>(1);
  auto const plan_for = [&](PatchCounts const& capacity) {
    auto const for_each = [&](int n) {
      return static_cast<std::size_t>(patches) * static_cast<std::size_t>(n);
    };
    plan.capacity = capacity;
    if (capacity.nodes > 0)
      plan.units = backend.template array<typename Planner::Unit>(
          for_each(Planner::units(patch_size, capacity)));
    plan.nodes = backend.template array<PatchNode>(for_each(capacity.nodes));
    plan.diagonals = backend.template array<std::uint16_t>(for_each(capacity.diagonals));
    launch("plan patches", shape, backend.stream(), plan_each_patch<Planner>, input, capacity,
           plan.units.data(), plan.nodes.data(), plan.diagonals.data(), most.data());
  };
  plan_for(guess);
  PatchCounts counts;
  most.download({&counts, 1});
  // What a patch stages shares the memory of a multiprocessor with others: there is little room to spare.
  bool const is_right = holds(guess, counts) && guess.slots <= counts.slots + counts.slots / 16 &&
                        guess.nodes <= counts.nodes + counts.nodes / 16;
  if (is_right && accepts(guess)) return plan;
  plan = {};
  auto const in_fours = [](int n) { return (n + 3) / 4 * 4; };
  PatchCounts const capacity{in_fours(counts.nodes), in_fours(counts.diagonals),
                             in_fours(counts.fans), in_fours(counts.slots)};
  plan.capacity = capacity;
  if (accepts(capacity)) plan_for(capacity);
  return plan;
}

}  // namespace pliant::detail
