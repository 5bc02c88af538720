#pragma once

#include <limits>
#include <utility>

#include <pliant/cuda/array.hpp>

namespace pliant {

struct CudaOptions {
  int device = 0;
  cudaStream_t stream = nullptr;  // nullptr: the backend makes its own
};

namespace detail {

/// What all copies of one backend share: a stream, and room for reductions.
class CudaContext {
 public:
  explicit CudaContext(CudaOptions const& options) : device_(options.device) {
    int count = 0;
    cudaError_t const status = cudaGetDeviceCount(&count);
    if (status != cudaSuccess || count == 0) {
      cudaGetLastError();
      throw Error("CUDA: no usable GPU (",
                  cudaGetErrorString(status == cudaSuccess ? cudaErrorNoDevice : status),
                  "). Run on a machine with one, or build for OpenMP.");
    }
    if (device_ < 0 || device_ >= count)
      throw Error("CUDA: device ", device_, " asked for, but there are ", count,
                  "; give a number from 0 to ", count - 1);
    make_current();
    partials_ = DeviceArray<double>(max_partials);
    check(cudaMallocHost(&result_, sizeof(double)), "cudaMallocHost");
    stream_ = options.stream;
    if (stream_ != nullptr) return;
    cudaError_t const made = cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking);
    if (made != cudaSuccess) cudaFreeHost(result_);
    check(made, "cudaStreamCreateWithFlags");
    owns_stream_ = true;
  }
  ~CudaContext() {
    if (owns_stream_) cudaStreamDestroy(stream_);
    cudaFreeHost(result_);
  }
  CudaContext(CudaContext const&) = delete;
  CudaContext& operator=(CudaContext const&) = delete;

  static constexpr int max_partials = 1024;

  /// Makes the backend's device the one of the calling thread.
  void make_current() const { check(cudaSetDevice(device_), "cudaSetDevice"); }
  cudaStream_t stream() const { return stream_; }
  double* partials() { return partials_.data(); }
  /// In host memory that kernels can write to.
  double* result() const { return result_; }
  void synchronize() const { check(cudaStreamSynchronize(stream_), "cudaStreamSynchronize"); }

 private:
  int device_;
  cudaStream_t stream_ = nullptr;
  bool owns_stream_ = false;
  DeviceArray<double> partials_;
  double* result_ = nullptr;
};

}  // namespace detail
}  // namespace pliant
