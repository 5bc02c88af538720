#pragma once

#include <cstddef>
#include <cstdint>

#include <pliant/backend/backend.hpp>
#include <pliant/cuda/nodes_of_patch.cuh>
#include <pliant/cuda/slot_planner.hpp>

// Tables of elements and their patches as kernels see them.
namespace pliant::detail {

/// Which patches of a table a kernel looks at.
struct ActiveList {
  Index const* list = nullptr;  // how many, then their numbers; null: all
  Index most = 0;               // how many the list has room for

  /// The patch of number k among these; negative behind the last one.
  __device__ __forceinline__ Index patch(Index k) const {
    if (list == nullptr) return k;
    return k < most && k < list[0] ? list[k + 1] : -1;
  }
};

/// An element table as kernels see it.
template <int Nodes>
struct ElementView {
  static constexpr int width = (Nodes + 3) / 4 * 4;
  Index count;
  Index const* connectivity;  // (elements, width)
  Tag const* tags;
  int patch_size;      // elements, at most
  Index const* first;  // (patches + 1), elements
  ActiveList active;

  /// The i-th element of the active patches; negative where the last patch has none.
  __device__ __forceinline__ Index element(Index i) const {
    Index end = count;
    if (active.list != nullptr) {
      Index const patch = active.patch(i / patch_size);
      if (patch < 0) return -1;
      i = first[patch] + i % patch_size;
      end = first[patch + 1];
    }
    return i < end ? i : -1;
  }
};

/// The patches of an element table as kernels see them.
template <class Unit>
struct PatchView {
  int patch_size;      // elements, at most
  Index const* first;  // (patches + 1), elements
  PatchCounts capacity;
  Tag const* tags;
  Unit const* units;               // PatchRow (elements), or FanVisit (patches, visits, fans)
  PatchNode const* nodes;          // (patches, node capacity)
  std::uint16_t const* diagonals;  // (patches, diagonal capacity)
  ActiveList active;

  __device__ __forceinline__ NodesOfPatch nodes_of(Index patch) const {
    return {nodes + static_cast<std::ptrdiff_t>(patch) * capacity.nodes, capacity.nodes};
  }
  __device__ __forceinline__ void load_diagonals(Index patch, std::uint16_t* to) const {
#pragma unroll 1
    for (int d = static_cast<int>(threadIdx.x); d < capacity.diagonals;
         d += static_cast<int>(blockDim.x))
      to[d] = diagonals[static_cast<std::ptrdiff_t>(patch) * capacity.diagonals + d];
  }
};

}  // namespace pliant::detail
