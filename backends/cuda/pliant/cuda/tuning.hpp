#pragma once

#include <pliant/config.hpp>

// The numbers that decide how fast, never what: swept by bench/backend/cuda_accumulate_bench.cu.
namespace pliant::detail {

inline constexpr int warp_size = 32;

/// Threads per block of loops over nodes, of reductions, and of visits to elements.
inline constexpr int node_threads = 256, reduce_threads = 256, visit_threads = 128;

/// How accumulation runs: patches of many elements add less to global memory, small ones occupy
/// all of a GPU while a mesh is small.
struct PatchTuning {
  int max_threads;   // per block; `threads` below may not exceed it
  int min_blocks;    // that fit a multiprocessor: with max_threads, bounds registers per thread
  int patch_size;    // elements
  int threads;       // per block
  int small_size;    // elements of a patch, and threads, while a mesh is small
  Index large_from;  // elements
};

template <class T, int Nodes>
constexpr PatchTuning patch_tuning() {
  constexpr bool single = sizeof(T) == 4;
  if (Nodes <= 4)
    return single ? PatchTuning{512, 2, 512, 512, 128, 150000}
                  : PatchTuning{512, 1, 512, 512, 128, 150000};
  if (Nodes <= 10)
    return single ? PatchTuning{128, 4, 128, 128, 128, 0} : PatchTuning{128, 2, 128, 128, 128, 0};
  return {64, 4, 64, 64, 64, 0};
}

}  // namespace pliant::detail
