#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <string>

#include <pliant/error.hpp>

namespace pliant::detail {

/// Throws Error when a CUDA call failed.
inline void check(cudaError_t status, char const* call) {
  if (status == cudaSuccess) return;
  cudaGetLastError();  // a failure reported here must not be reported again by the next call
  std::string advice;
  switch (status) {
    case cudaErrorNoKernelImageForDevice:
    case cudaErrorUnsupportedPtxVersion:
      advice = "; compile for the architecture of this GPU (CMAKE_CUDA_ARCHITECTURES)";
      break;
    case cudaErrorStreamCaptureUnsupported:
    case cudaErrorStreamCaptureInvalidated:
      advice = "; a function given to record may only call verbs that return nothing";
      break;
    case cudaErrorIllegalAddress:
    case cudaErrorLaunchFailure:
    case cudaErrorMisalignedAddress:
      advice =
          "; an earlier kernel left its arrays and the GPU context is lost: start the program "
          "anew, under compute-sanitizer with PLIANT_EXACT_MEMORY=1 to see which kernel";
      break;
    default:
      advice = "; look the code up in the CUDA runtime's list of errors";
  }
  throw Error("CUDA: ", call, " failed: ", cudaGetErrorString(status), " (",
              cudaGetErrorName(status), ")", advice);
}

/// Throws Error when so many bytes were not to be had from the current device.
inline void check_memory(cudaError_t status, std::size_t bytes) {
  if (status != cudaErrorMemoryAllocation) return check(status, "cudaMalloc");
  cudaGetLastError();
  std::size_t free = 0, total = 0;
  cudaMemGetInfo(&free, &total);
  throw Error("CUDA: out of memory: an array of ", bytes, " bytes was asked for, and ", free,
              " of ", total,
              " bytes are free; use a coarser mesh, single precision, or a larger GPU");
}

}  // namespace pliant::detail
