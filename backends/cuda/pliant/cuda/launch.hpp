#pragma once

#include <pliant/config.hpp>
#include <pliant/cuda/check.hpp>

namespace pliant::detail {

struct LaunchShape {
  Index blocks;
  int threads;
  int shared_bytes = 0;  // dynamic shared memory per block
};

/// Launches a kernel; `verb` names it in the Error when that fails.
template <class... Parameters, class... Arguments>
void launch(char const* verb, LaunchShape const& shape, cudaStream_t stream,
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
  check(cudaLaunchKernelEx(&config, kernel, arguments...), verb);
}

}  // namespace pliant::detail
