#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <pliant/cuda/stream.hpp>

namespace pliant::detail {

/// Memory of the device that verbs need on their way, one after the other in the order of the stream. It stays from one to the
/// next, and grows by half at least.
class DeviceScratch {
 public:
  explicit DeviceScratch(SharedStream stream) : stream_(std::move(stream)) {}

  /// So many bytes, on the boundary of 256 of them, not set; until the next call. The stream's device has to be the current
  /// one. What a recording uses stays: it is there when that is replayed.
  std::byte* take(std::size_t bytes) {
    cudaStreamCaptureStatus status{};
    check(cudaStreamIsCapturing(stream_->get(), &status), "cudaStreamIsCapturing");
    bool const recording = status != cudaStreamCaptureStatusNone;
    if (bytes > size_) grow(std::max(bytes, size_ + size_ / 2), recording);
    is_recorded_ = is_recorded_ || recording;
    return memory_.get();
  }

 private:
  struct Release {
    SharedStream stream;
    std::size_t bytes;  // 0: not of the stream
    void operator()(std::byte* memory) const noexcept {
      DeviceGuard const device(stream->device(), std::nothrow);
      if (bytes > 0)
        stream->release(memory, bytes);
      else
        cudaFree(memory);
    }
  };
  using Memory = std::unique_ptr<std::byte, Release>;

  void grow(std::size_t bytes, bool recording) {
    if (is_recorded_ || recording)
      outgrown_.push_back(std::move(memory_));
    else
      memory_.reset();
    size_ = 0;
    is_recorded_ = false;
    memory_ = recording ? allocate_while_recording(bytes) : allocate(bytes);
    size_ = bytes;
  }
  Memory allocate(std::size_t bytes) const {
    std::byte* memory = nullptr;
    check_memory(stream_->allocate(&memory, bytes), bytes);
    return {memory, Release{stream_, bytes}};
  }
  /// Now, in place of each time that the recording is replayed.
  Memory allocate_while_recording(std::size_t bytes) const {
    auto mode = cudaStreamCaptureModeRelaxed;
    check(cudaThreadExchangeStreamCaptureMode(&mode), "cudaThreadExchangeStreamCaptureMode");
    std::byte* memory = nullptr;
    cudaError_t const status = cudaMalloc(&memory, bytes);
    cudaThreadExchangeStreamCaptureMode(&mode);
    check_memory(status, bytes);
    return {memory, Release{stream_, 0}};
  }

  SharedStream stream_;
  Memory memory_;
  std::size_t size_ = 0;
  bool is_recorded_ = false;
  std::vector<Memory> outgrown_;
};

}  // namespace pliant::detail
