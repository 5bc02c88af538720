#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include <pliant/cuda/check.hpp>

namespace pliant {

/// An owning, movable array in the memory of the thread's current device.
template <class U>
class DeviceArray {
 public:
  DeviceArray() = default;
  /// Zeroed. Throws Error when the device has not enough memory.
  explicit DeviceArray(std::size_t count) : size_(count) {
    if (count == 0) return;
    allocate();
    // Other streams do not wait for the legacy stream that zeroes.
    cudaError_t status = cudaMemsetAsync(data_, 0, count * sizeof(U), cudaStreamLegacy);
    if (status == cudaSuccess) status = cudaStreamSynchronize(cudaStreamLegacy);
    if (status != cudaSuccess) cudaFree(data_);
    detail::check(status, "cudaMemset");
  }
  ~DeviceArray() { cudaFree(data_); }
  DeviceArray(DeviceArray&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  DeviceArray& operator=(DeviceArray&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }

  U* data() { return data_; }
  U const* data() const { return data_; }
  std::size_t size() const { return size_; }

  /// Overwrites the first values, after all work that was launched before.
  void upload(std::span<U const> values) {
    copy(data_, values.data(), values.size(), cudaMemcpyHostToDevice);
  }
  /// Reads the first values, after all work that was launched before.
  void download(std::span<U> values) const {
    copy(values.data(), data_, values.size(), cudaMemcpyDeviceToHost);
  }

 private:
  void allocate() {
    cudaError_t const status = cudaMalloc(&data_, size_ * sizeof(U));
    if (status != cudaErrorMemoryAllocation) return detail::check(status, "cudaMalloc");
    cudaGetLastError();
    std::size_t free = 0, total = 0;
    cudaMemGetInfo(&free, &total);
    throw Error("CUDA: out of memory: an array of ", size_ * sizeof(U),
                " bytes was asked for, and ", free, " of ", total,
                " bytes are free; use a coarser mesh, single precision, or a larger GPU");
  }
  void copy(void* to, void const* from, std::size_t count, cudaMemcpyKind kind) const {
    if (count > size_)
      throw Error("CUDA: copy of ", count, " values, but the array holds ", size_,
                  "; make the array larger");
    if (count == 0) return;
    // An array does not know which streams use it, so it waits for all.
    detail::check(cudaDeviceSynchronize(), "cudaDeviceSynchronize");
    detail::check(cudaMemcpyAsync(to, from, count * sizeof(U), kind, cudaStreamLegacy),
                  "cudaMemcpyAsync");
    detail::check(cudaStreamSynchronize(cudaStreamLegacy), "cudaMemcpyAsync");
  }

  U* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace pliant
