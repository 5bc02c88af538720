#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include <pliant/cuda/device_guard.hpp>
#include <pliant/cuda/small_blocks.hpp>

namespace pliant {

/// Which GPU, and where on it work is queued.
///
/// By default a backend makes a stream of its own, one above the least priority, which neither waits for the legacy
/// default stream (stream 0) nor is waited for by it. Work of a caller's own that a backend's verbs read has to be
/// finished before they are called, or ordered by an event: `cudaStreamWaitEvent(backend.stream(),
/// event)`; and the other way round after `backend.synchronize()` or an event recorded on
/// `backend.stream()`. A caller who passes `stream`, one of `device`, has his work and the backend's in
/// one order without any of this. He destroys it after the backend, its copies and all that they
/// made; it must not be a legacy default stream if `record` is used, which CUDA cannot capture.
struct CudaOptions {
  int device = 0;
  cudaStream_t stream = nullptr;  // nullptr: the backend makes its own
};

namespace detail {

/// A device and a stream of it. All that a backend makes shares it and keeps it alive. With PLIANT_EXACT_MEMORY in the
/// environment no memory is kept and all has the size that was asked for, for tools that look at its bounds.
class DeviceStream {
 public:
  explicit DeviceStream(CudaOptions const& options)
      : device_(checked(options.device)), stream_(options.stream) {
    auto const guard = enter();
    use_pool();
    if (stream_ == nullptr) {
      check(cudaStreamCreateWithPriority(&stream_, cudaStreamNonBlocking, above_side_streams),
            "cudaStreamCreateWithPriority");
      owns_stream_ = true;
    }
    cudaError_t const status = cudaMallocHost(&staged_, most_staged);
    if (status != cudaSuccess && owns_stream_) cudaStreamDestroy(stream_);
    check(status, "cudaMallocHost");
  }
  ~DeviceStream() {
    DeviceGuard const device(device_, std::nothrow);
    blocks_.clear([&](void* block) { give_back(block); });
    cudaFreeHost(staged_);
    if (owns_stream_) cudaStreamDestroy(stream_);
  }
  DeviceStream(DeviceStream const&) = delete;
  DeviceStream& operator=(DeviceStream const&) = delete;

  int device() const { return device_; }
  cudaStream_t get() const { return stream_; }
  /// The device is the calling thread's current one while what this returns lives.
  [[nodiscard]] DeviceGuard enter() const { return DeviceGuard(device_); }
  void synchronize() const { check(cudaStreamSynchronize(stream_), "cudaStreamSynchronize"); }
  /// Copies to the host what is in the device's memory once all that was queued before is done, and waits for it. A little of it
  /// goes through memory that is pinned, which takes less time.
  void download(void* to, void const* from, std::size_t bytes) const {
    bool const is_little = bytes <= most_staged;
    check(cudaMemcpyAsync(is_little ? staged_ : to, from, bytes, cudaMemcpyDeviceToHost, stream_),
          "cudaMemcpyAsync");
    synchronize();
    if (is_little) std::memcpy(to, staged_, bytes);
  }

  /// Memory of the device, which is the current one, for work that is queued from now on.
  template <class U>
  [[nodiscard]] cudaError_t allocate(U** memory, std::size_t bytes) const {
    *memory = keeps(bytes) ? static_cast<U*>(blocks_.take(bytes)) : nullptr;
    if (*memory != nullptr) return cudaSuccess;
    // Whole blocks while work is recorded, too: what is given back has the size of one.
    std::size_t const whole =
        exact_ || !SmallBlocks::is_small(bytes) ? bytes : SmallBlocks::size_for(bytes);
    return uses_pool_ ? cudaMallocAsync(memory, whole, stream_) : cudaMalloc(memory, whole);
  }
  /// Gives it back, with the bytes that it was asked for, once the work that was queued has used it.
  void release(void* memory, std::size_t bytes) const noexcept {
    if (!keeps(bytes) || !blocks_.keep(memory, bytes)) give_back(memory);
  }

 private:
  static constexpr int above_side_streams = -1;  // which have the least priority, 0
  static constexpr std::size_t most_staged = 64 << 10;

  /// Whether memory of this size is kept for work to come. While work is recorded it is not, since that
  /// may be replayed.
  bool keeps(std::size_t bytes) const noexcept {
    if (!SmallBlocks::is_small(bytes) || exact_) return false;
    cudaStreamCaptureStatus status{};
    return cudaStreamIsCapturing(stream_, &status) == cudaSuccess &&
           status == cudaStreamCaptureStatusNone;
  }
  void give_back(void* memory) const noexcept {
    if (uses_pool_)
      cudaFreeAsync(memory, stream_);
    else
      cudaFree(memory);
  }

  /// Takes memory from the pool of the device, where it has one: that takes a fraction of the time, and waits for nothing. The
  /// pool keeps what is free of it, a sixteenth of the device's memory at most, unless the program said how much.
  void use_pool() {
    int has_pools = 0;
    check(cudaDeviceGetAttribute(&has_pools, cudaDevAttrMemoryPoolsSupported, device_),
          "cudaDeviceGetAttribute");
    if (has_pools == 0) return;
    cudaMemPool_t pool = nullptr;
    std::uint64_t kept = 0;
    check(cudaDeviceGetDefaultMemPool(&pool, device_), "cudaDeviceGetDefaultMemPool");
    check(cudaMemPoolGetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &kept),
          "cudaMemPoolGetAttribute");
    if (kept == 0) {
      std::size_t free = 0, total = 0;
      check(cudaMemGetInfo(&free, &total), "cudaMemGetInfo");
      kept = total / 16;
      check(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &kept),
            "cudaMemPoolSetAttribute");
    }
    uses_pool_ = true;
  }

  static int checked(int device) {
    int count = 0;
    cudaError_t const status = cudaGetDeviceCount(&count);
    if (status != cudaSuccess || count == 0) {
      cudaGetLastError();
      throw Error("CUDA: no usable GPU (",
                  cudaGetErrorString(status == cudaSuccess ? cudaErrorNoDevice : status),
                  "). Run on a machine with one, or build for OpenMP.");
    }
    if (device < 0 || device >= count)
      throw Error("CUDA: device ", device, " asked for, but there are ", count,
                  "; give a number from 0 to ", count - 1);
    return device;
  }

  int device_;
  cudaStream_t stream_;
  bool owns_stream_ = false, uses_pool_ = false;
  bool exact_ = std::getenv("PLIANT_EXACT_MEMORY") != nullptr;
  mutable SmallBlocks blocks_;
  void* staged_ = nullptr;  // (most_staged), the host's
};

using SharedStream = std::shared_ptr<DeviceStream const>;

}  // namespace detail
}  // namespace pliant
