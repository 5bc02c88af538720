#pragma once

#include <pliant/cuda/array.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/patch_plan.hpp>

// Patches are planned where they are used: a block plans one, in its shared memory.
namespace pliant::detail {

/// The patches of an element table.
template <int Nodes>
struct PatchPlan {
  int patch_size = 0;                    // elements
  int node_capacity = 0;                 // of a patch; multiple of 4
  int diagonal_capacity = 0;             // of a patch; multiple of 4
  DeviceArray<PatchRow<Nodes>> rows;     // (elements)
  DeviceArray<PatchNode> nodes;          // (patches, node_capacity)
  DeviceArray<std::uint16_t> diagonals;  // (patches, diagonal_capacity)
};

inline constexpr int plan_threads = 128;

/// The shared memory that planning patches of a size takes, bytes.
template <int Nodes>
constexpr int plan_bytes(int patch_size) {
  return PatchPlanner<Nodes>::bytes(patch_size) + int{sizeof(PatchCounts)};
}

/// Rows of a table's node numbers, cut into patches.
template <int Nodes>
struct PatchInput {
  Index count;                // elements
  Index const* connectivity;  // (elements, width)
  int width, patch_size;

  __device__ Index first() const { return static_cast<Index>(blockIdx.x) * patch_size; }
  /// The planner of the block's patch, its nodes numbered and counted in `counts`, which the threads share.
  __device__ PatchPlanner<Nodes> begin(void* memory, PatchCounts* counts) const {
    Index const left = count - first();
    PatchPlanner<Nodes> planner(memory, patch_size, left < patch_size ? left : patch_size);
    planner.read(connectivity + std::int64_t{first()} * width, width, static_cast<int>(threadIdx.x),
                 plan_threads);
    __syncthreads();
    if (threadIdx.x == 0) *counts = planner.number_nodes();
    __syncthreads();
    return planner;
  }
};

/// The most nodes and diagonals that a patch has.
template <int Nodes>
__global__ void __launch_bounds__(plan_threads)
    count_patch_nodes(PatchInput<Nodes> input, PatchCounts* most) {
  extern __shared__ __align__(16) char planner_memory[];
  __shared__ PatchCounts counts;
  (void)input.begin(planner_memory, &counts);
  if (threadIdx.x > 0) return;
  atomicMax(&most->nodes, counts.nodes);
  atomicMax(&most->diagonals, counts.diagonals);
}

template <int Nodes>
__global__ void __launch_bounds__(plan_threads)
    plan_patch(PatchInput<Nodes> input, PatchRow<Nodes>* rows, PatchNode* nodes, int node_capacity,
               std::uint16_t* diagonals, int diagonal_capacity) {
  extern __shared__ __align__(16) char planner_memory[];
  __shared__ PatchCounts counts;
  auto planner = input.begin(planner_memory, &counts);
  auto const patch = static_cast<std::int64_t>(blockIdx.x);
  int const thread = static_cast<int>(threadIdx.x);
  if (thread == 0) planner.sort_by_valence(counts);
  __syncthreads();
  planner.write_nodes(counts, nodes + patch * node_capacity, node_capacity,
                      diagonals + patch * diagonal_capacity, diagonal_capacity, thread,
                      plan_threads);
  __syncthreads();
  if (thread == 0) planner.assign_slots();
  __syncthreads();
  planner.write_rows(rows + input.first(), thread, plan_threads);
}

/// Waits for the device.
template <int Nodes, class B>
PatchPlan<Nodes> plan_patches(B const& backend, DeviceArray<Index> const& connectivity, Index count,
                              int width, int patch_size) {
  PatchPlan<Nodes> plan;
  plan.patch_size = patch_size;
  if (count == 0) return plan;
  DeviceGuard const device(backend.device());
  PatchInput<Nodes> const input{count, connectivity.data(), width, patch_size};
  Index const patches = (count - 1) / patch_size + 1;
  LaunchShape const shape{patches, plan_threads, PatchPlanner<Nodes>::bytes(patch_size)};
  auto most = backend.template array<PatchCounts>(1);
  launch("plan patches", shape, backend.stream(), count_patch_nodes<Nodes>, input, most.data());
  PatchCounts counts;
  most.download({&counts, 1});
  auto const in_fours = [](int n) { return (n + 3) / 4 * 4; };
  auto const rows_of = [&](int n) {
    return static_cast<std::size_t>(patches) * static_cast<std::size_t>(n);
  };
  plan.node_capacity = in_fours(counts.nodes);
  plan.diagonal_capacity = in_fours(counts.diagonals);
  plan.rows = backend.template array<PatchRow<Nodes>>(static_cast<std::size_t>(count));
  plan.nodes = backend.template array<PatchNode>(rows_of(plan.node_capacity));
  plan.diagonals = backend.template array<std::uint16_t>(rows_of(plan.diagonal_capacity));
  launch("plan patches", shape, backend.stream(), plan_patch<Nodes>, input, plan.rows.data(),
         plan.nodes.data(), plan.node_capacity, plan.diagonals.data(), plan.diagonal_capacity);
  return plan;
}

}  // namespace pliant::detail
