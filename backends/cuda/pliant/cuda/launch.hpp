#pragma once

#include <pliant/config.hpp>
#include <pliant/cuda/check.hpp>

namespace pliant::detail {

struct LaunchShape {
  Index blocks;
  int threads;
  int shared_bytes = 0;  // dynamic shared memory per block
};

/// When a kernel may start. One that is launched `early` calls `begin_after_previous_kernel` before
/// it reads or writes what other kernels do, all of it in every thread.
enum class Start { in_order, early };

/// Waits for the kernels before this one in the stream, and lets the next one start early.
__device__ __forceinline__ void begin_after_previous_kernel() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  cudaTriggerProgrammaticLaunchCompletion();
  cudaGridDependencySynchronize();
#endif
}

/// Launches a kernel; `verb` names it in the Error when that fails.
template <class... Parameters, class... Arguments>
void launch(Start start, char const* verb, LaunchShape const& shape, cudaStream_t stream,
            void (*kernel)(Parameters...), Arguments const&... arguments) {
  constexpr int without_asking = 48 << 10;
  if (shape.shared_bytes > without_asking)
    check(cudaFuncSetAttribute(reinterpret_cast<void const*>(kernel),
                               cudaFuncAttributeMaxDynamicSharedMemorySize, shape.shared_bytes),
          verb);
  cudaLaunchConfig_t config{};
  config.gridDim = dim3(static_cast<unsigned>(shape.blocks));
  config.blockDim = dim3(static_cast<unsigned>(shape.threads));
  config.dynamicSmemBytes = static_cast<std::size_t>(shape.shared_bytes);
  config.stream = stream;
  cudaLaunchAttribute early{};
  early.id = cudaLaunchAttributeProgrammaticStreamSerialization;
  early.val.programmaticStreamSerializationAllowed = 1;
  config.attrs = &early;
  config.numAttrs = start == Start::early ? 1 : 0;
  check(cudaLaunchKernelEx(&config, kernel, arguments...), verb);
}
template <class... Parameters, class... Arguments>
void launch(char const* verb, LaunchShape const& shape, cudaStream_t stream,
            void (*kernel)(Parameters...), Arguments const&... arguments) {
  launch(Start::in_order, verb, shape, stream, kernel, arguments...);
}

}  // namespace pliant::detail
