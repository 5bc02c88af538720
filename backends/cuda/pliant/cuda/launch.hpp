#pragma once

#include <mutex>

#include <cooperative_groups.h>

#include <pliant/config.hpp>
#include <pliant/cuda/check.hpp>

namespace pliant::detail {

struct LaunchShape {
  Index blocks;
  int threads;
  int shared_bytes = 0;  // dynamic shared memory per block
  int cluster = 1;       // blocks that may wait for each other; see clusters_can_be_launched
};

/// Whether blocks of a kernel can be a cluster on a device: of compute capability 9, and compiled for it.
inline bool clusters_can_be_launched(void const* kernel, int device) {
  int can = 0;
  check(cudaDeviceGetAttribute(&can, cudaDevAttrClusterLaunch, device), "cudaDeviceGetAttribute");
  cudaFuncAttributes attributes{};
  check(cudaFuncGetAttributes(&attributes, kernel), "cudaFuncGetAttributes");
  return can != 0 && attributes.ptxVersion >= 90;
}

/// When a kernel may start. One that is launched `early` calls `begin_after_previous_kernel` before
/// it reads or writes what other kernels do, all of it in every thread.
enum class Start { in_order, early };

/// Whether the next kernel may start before this one has ended.
enum class Next { early, in_order };

/// Waits for the kernels before this one in the stream, and lets the next one start early.
template <Next next = Next::early>
__device__ __forceinline__ void begin_after_previous_kernel() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  if constexpr (next == Next::early) cudaTriggerProgrammaticLaunchCompletion();
  cudaGridDependencySynchronize();
#endif
}

/// At the end of a kernel that started before the one before it had ended, and reads nothing of that: ends behind it.
__device__ __forceinline__ void end_after_previous_kernel() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  cudaGridDependencySynchronize();
#endif
}

/// In every thread of a launch of one block, or of one cluster: what any wrote before, all see then.
__device__ __forceinline__ void wait_for_cluster() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  if (gridDim.x > 1) return cooperative_groups::this_cluster().sync();
#endif
  __syncthreads();
}

/// The dynamic shared memory, in bytes, that a block may ask for on a device.
inline int most_shared_bytes(int device) {
  int most = 0;
  check(cudaDeviceGetAttribute(&most, cudaDevAttrMaxSharedMemoryPerBlockOptin, device),
        "cudaDeviceGetAttribute");
  return most;
}

/// Lets a kernel ask for so much dynamic shared memory. What it may ask for is never lowered: recordings hold
/// launches of the same kernel with more.
inline void allow_shared_bytes(void const* kernel, int bytes, char const* verb) {
  static std::mutex mutex;  // between the question and the answer
  std::lock_guard const lock(mutex);
  cudaFuncAttributes attributes{};
  check(cudaFuncGetAttributes(&attributes, kernel), verb);
  if (attributes.maxDynamicSharedSizeBytes >= bytes) return;
  int device = 0;
  check(cudaGetDevice(&device), verb);
  int const most = most_shared_bytes(device) - static_cast<int>(attributes.sharedSizeBytes);
  if (bytes > most)
    throw Error("CUDA: ", verb, " needs ", bytes,
                " bytes of shared memory per block, and this GPU has ", most,
                "; number elements so that neighbours share nodes, or make patches smaller");
  check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, bytes), verb);
}

/// Launches a kernel; `verb` names it in the Error when that fails.
template <class... Parameters, class... Arguments>
void launch(Start start, char const* verb, LaunchShape const& shape, cudaStream_t stream,
            void (*kernel)(Parameters...), Arguments const&... arguments) {
  constexpr int without_asking = 48 << 10;
  if (shape.shared_bytes > without_asking)
    allow_shared_bytes(reinterpret_cast<void const*>(kernel), shape.shared_bytes, verb);
  cudaLaunchConfig_t config{};
  config.gridDim = dim3(static_cast<unsigned>(shape.blocks));
  config.blockDim = dim3(static_cast<unsigned>(shape.threads));
  config.dynamicSmemBytes = static_cast<std::size_t>(shape.shared_bytes);
  config.stream = stream;
  cudaLaunchAttribute attributes[2] = {};
  config.attrs = attributes;
  if (start == Start::early) {
    auto& early = attributes[config.numAttrs++];
    early.id = cudaLaunchAttributeProgrammaticStreamSerialization;
    early.val.programmaticStreamSerializationAllowed = 1;
  }
  if (shape.cluster > 1) {
    auto& cluster = attributes[config.numAttrs++];
    cluster.id = cudaLaunchAttributeClusterDimension;
    cluster.val.clusterDim.x = static_cast<unsigned>(shape.cluster);
    cluster.val.clusterDim.y = cluster.val.clusterDim.z = 1;
  }
  check(cudaLaunchKernelEx(&config, kernel, arguments...), verb);
}
template <class... Parameters, class... Arguments>
void launch(char const* verb, LaunchShape const& shape, cudaStream_t stream,
            void (*kernel)(Parameters...), Arguments const&... arguments) {
  launch(Start::in_order, verb, shape, stream, kernel, arguments...);
}

}  // namespace pliant::detail
