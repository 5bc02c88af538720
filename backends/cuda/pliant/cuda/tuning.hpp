#pragma once

#include <pliant/config.hpp>

// The numbers that decide how fast, never what: swept by bench/backend/cuda_patches_bench.cu.
namespace pliant::detail {

inline constexpr int warp_size = 32;

/// Threads per block of loops over nodes, of reductions, and of visits to elements; and that take a patch's plan from another.
inline constexpr int node_threads = 256, reduce_threads = 256, visit_threads = 128,
                     scatter_threads = 128, take_threads = 256;

/// Loops over lists (scan.cuh, sort.cuh): threads per block, the most blocks, keys that a thread sorts at once, and how long a
/// list one block sorts alone, in one launch.
inline constexpr int list_threads = 256, most_list_blocks = 1024, sort_keys = 8;
inline constexpr Index short_list = 4096;
/// The same of loops, scans and sorts that one launch does in turn (in_turn.cuh), by as many blocks as any GPU with clusters has
/// room for in one.
inline constexpr int bits_of_short_steps = 11;
inline constexpr Index short_steps = 1 << bits_of_short_steps;
inline constexpr int step_cluster = 8;
/// How many keys such a cluster sorts in one launch.
inline constexpr Index most_cluster_keys = 32768;

/// Whether each element adds to its nodes in global memory by itself, as vectors. That is fast
/// where an element computes much per node; patches are faster elsewhere, and where there are no
/// vector adds (double precision).
template <class T, int Nodes>
inline constexpr bool scatters = Nodes >= 20 || (sizeof(T) == 4 && Nodes >= 8);

/// Blocks of loops that scatter that fit a multiprocessor, which bounds registers per thread; 0: as they come. Hex8 has
/// room for all it works on.
template <int Nodes, int C, int Fields>
inline constexpr int scatter_blocks = Nodes == 8 && C == 3 ? (Fields == 2 ? 4 : 3) : 0;

/// Threads per block where several share an element's points (point_rows.cuh), and blocks that fit a multiprocessor.
inline constexpr int row_threads = 64;
template <class T>
inline constexpr int row_blocks = sizeof(T) == 8 ? 4 : 8;

/// How patches accumulate: those of many elements add less to global memory, small ones occupy all
/// of a GPU while a mesh is small.
struct PatchTuning {
  int max_threads;   // per block; `threads` and `small_size` may not exceed it
  int min_blocks;    // that fit a multiprocessor: with max_threads, bounds registers per thread
  bool prefetch;     // load the places of the next element while computing this one
  int patch_size;    // elements
  int threads;       // per block
  int small_size;    // elements of a patch, and threads, while a mesh is small
  Index large_from;  // elements
};

template <class T, int Nodes>
constexpr PatchTuning patch_tuning() {
  if (Nodes <= 4)
    return sizeof(T) == 4 ? PatchTuning{256, 5, true, 768, 256, 192, 300000}
                          : PatchTuning{256, 3, true, 384, 128, 96, 150000};
  if (Nodes == 8) return {128, 2, false, 128, 128, 64, 100000};
  if (Nodes <= 10) return {128, 2, false, 64, 64, 64, 0};
  return {64, 4, false, 64, 64, 64, 0};
}

/// How patches of tetrahedra accumulate in fans (accumulate_fans.cuh).
struct FanTuning {
  int max_threads;       // per block; `threads` may not exceed it
  int min_blocks;        // that fit a multiprocessor
  int patch_size;        // elements, 1024 at most
  int threads;           // per block: a fan each
  Index least_elements;  // of a table in fans
};

template <class T>
constexpr FanTuning fan_tuning() {
  return sizeof(T) == 4 ? FanTuning{128, 7, 768, 128, 600000} : FanTuning{128, 4, 768, 128, 300000};
}

/// Lists of so few patches are not accumulated in fans, of which a thread takes one element after the other, but an element
/// in a thread: where most multiprocessors have no block, all wait for memory. On an H100 39 patches take less than half the
/// time so, and 127 half as much again (Tet4, float; bench/adaptation, sleep).
inline constexpr Index few_patches = 64;

/// Kernels of few operations need few registers.
template <class Kernel>
concept LightKernel = requires { requires Kernel::few_operations; };

/// Blocks that fit a multiprocessor: others than light kernels spill registers under the bound that suits
/// those. Most lose more by it (up to a third of their time) than by having fewer threads; isochoric
/// neo-Hookean and Guccione tetrahedra in single precision lose 3 % without it.
template <class T, int Nodes, class Kernel>
inline constexpr int resident_blocks =
    LightKernel<Kernel> ? patch_tuning<T, Nodes>().min_blocks
                        : patch_tuning<T, Nodes>().min_blocks * 4 / 5;

/// The same where fans accumulate: what a thread keeps from element to element takes registers.
template <class T, class Kernel>
inline constexpr int fan_blocks =
    LightKernel<Kernel> ? fan_tuning<T>().min_blocks : fan_tuning<T>().min_blocks * 4 / 5;

}  // namespace pliant::detail
