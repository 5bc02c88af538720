#pragma once

#include <new>

#include <pliant/cuda/check.hpp>

namespace pliant::detail {

/// Makes a device the calling thread's current one, and the one before that current again at the
/// end of its life.
class DeviceGuard {
 public:
  explicit DeviceGuard(int device) : DeviceGuard(device, std::nothrow) {
    check(status_, "cudaSetDevice");
  }
  /// For destructors.
  DeviceGuard(int device, std::nothrow_t) noexcept : device_(device), before_(device) {
    status_ = cudaGetDevice(&before_);
    if (status_ == cudaSuccess && before_ != device_) status_ = cudaSetDevice(device_);
  }
  ~DeviceGuard() {
    if (before_ != device_) cudaSetDevice(before_);
  }
  DeviceGuard(DeviceGuard const&) = delete;
  DeviceGuard& operator=(DeviceGuard const&) = delete;

 private:
  int device_, before_;
  cudaError_t status_;
};

}  // namespace pliant::detail
