#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>

#include <pliant/cuda/stream.hpp>

namespace pliant::detail {

/// A second stream of a backend's device, for work that what is queued on the backend's stream behind it need not wait for.
class SideStream {
 public:
  static constexpr std::size_t mail_bytes = 64;

  explicit SideStream(SharedStream main) : main_(std::move(main)) {
    auto const device = main_->enter();
    try {
      check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking),
            "cudaStreamCreateWithFlags");
      check(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming), "cudaEventCreate");
      check(cudaMallocHost(&mail_, mail_bytes), "cudaMallocHost");
    } catch (...) {
      release();
      throw;
    }
  }
  ~SideStream() { release(); }
  SideStream(SideStream const&) = delete;
  SideStream& operator=(SideStream const&) = delete;

  /// What is queued there from now on waits for what was queued on the backend's stream so far.
  cudaStream_t begin() {
    auto const device = main_->enter();
    check(cudaEventRecord(event_, main_->get()), "cudaEventRecord");
    check(cudaStreamWaitEvent(stream_, event_, 0), "cudaStreamWaitEvent");
    return stream_;
  }
  cudaStream_t get() const { return stream_; }
  /// Waits for all that was queued there.
  void wait() const { check(cudaStreamSynchronize(stream_), "cudaStreamSynchronize"); }
  /// For destructors.
  void wait(std::nothrow_t) const noexcept { cudaStreamSynchronize(stream_); }
  /// In the host's memory, for what work there tells; of one piece of work at a time.
  void* mail() const { return mail_; }

 private:
  void release() noexcept {
    DeviceGuard const device(main_->device(), std::nothrow);
    if (mail_ != nullptr) cudaFreeHost(mail_);
    if (event_ != nullptr) cudaEventDestroy(event_);
    if (stream_ != nullptr) cudaStreamDestroy(stream_);
  }

  SharedStream main_;
  cudaStream_t stream_ = nullptr;
  cudaEvent_t event_ = nullptr;
  void* mail_ = nullptr;
};

/// Work on a side stream, which ends before this does.
class SideWork {
 public:
  SideWork() = default;
  explicit SideWork(std::shared_ptr<SideStream> stream) : stream_(std::move(stream)) {}
  ~SideWork() {
    if (stream_) stream_->wait(std::nothrow);
  }
  SideWork(SideWork&&) = default;
  SideWork& operator=(SideWork&& other) noexcept {
    std::swap(stream_, other.stream_);
    return *this;
  }
  SideStream& stream() const { return *stream_; }

 private:
  std::shared_ptr<SideStream> stream_;
};

}  // namespace pliant::detail
