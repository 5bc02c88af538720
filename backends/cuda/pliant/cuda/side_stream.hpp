#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

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
  /// Room in the host's memory for what a piece of work there tells, of mail_bytes; that of another one behind give_mail.
  void* take_mail() {
    if (free_mails_.empty()) {
      auto const device = main_->enter();
      mails_.reserve(mails_.size() + 1);
      free_mails_.reserve(mails_.size() + 1);
      void* mail = nullptr;
      check(cudaMallocHost(&mail, mail_bytes), "cudaMallocHost");
      mails_.push_back(mail);
      free_mails_.push_back(mail);
    }
    void* const mail = free_mails_.back();
    free_mails_.pop_back();
    return mail;
  }
  void give_mail(void* mail) noexcept { free_mails_.push_back(mail); }

 private:
  void release() noexcept {
    DeviceGuard const device(main_->device(), std::nothrow);
    for (void* mail : mails_) cudaFreeHost(mail);
    if (event_ != nullptr) cudaEventDestroy(event_);
    if (stream_ != nullptr) cudaStreamDestroy(stream_);
  }

  SharedStream main_;
  cudaStream_t stream_ = nullptr;
  cudaEvent_t event_ = nullptr;
  std::vector<void*> mails_, free_mails_;  // the latter has room for all
};

/// A piece of work on a side stream, which ends before this does.
class SideWork {
 public:
  explicit SideWork(std::shared_ptr<SideStream> stream)
      : stream_(std::move(stream)), mail_(stream_->take_mail()) {}
  ~SideWork() {
    if (!stream_) return;
    stream_->wait(std::nothrow);
    stream_->give_mail(mail_);
  }
  SideWork(SideWork&&) = default;
  SideWork& operator=(SideWork&&) = delete;

  SideStream& stream() const { return *stream_; }
  /// In the host's memory, for what the work tells.
  void* mail() const { return mail_; }

 private:
  std::shared_ptr<SideStream> stream_;
  void* mail_;
};

}  // namespace pliant::detail
