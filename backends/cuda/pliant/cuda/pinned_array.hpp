#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include <pliant/backend/array_bytes.hpp>
#include <pliant/cuda/stream.hpp>

namespace pliant {

/// An owning, movable array in memory of the host that kernels can write to. To make one and to let it go takes as long as some
/// launches do.
template <class U>
class PinnedArray {
 public:
  PinnedArray() = default;
  /// Not set. Throws Error when there is not enough memory.
  PinnedArray(detail::SharedStream stream, std::size_t count)
      : stream_(std::move(stream)), size_(count) {
    if (count == 0) return;
    auto const device = stream_->enter();
    std::size_t const bytes = detail::array_bytes<U>(count);
    void* memory = nullptr;
    detail::check_memory(cudaMallocHost(&memory, bytes), bytes);
    data_ = static_cast<U*>(memory);
  }
  ~PinnedArray() {
    if (data_ == nullptr) return;
    detail::DeviceGuard const device(stream_->device(), std::nothrow);
    cudaStreamSynchronize(stream_->get());  // kernels may still write
    cudaFreeHost(data_);
  }
  PinnedArray(PinnedArray&& other) noexcept
      : stream_(std::move(other.stream_)),
        data_(std::exchange(other.data_, nullptr)),
        size_(std::exchange(other.size_, 0)) {}
  PinnedArray& operator=(PinnedArray&& other) noexcept {
    std::swap(stream_, other.stream_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }

  U* data() { return data_; }
  U const* data() const { return data_; }
  std::size_t size() const { return size_; }
  /// What kernels wrote before the stream was waited for the last time.
  std::span<U const> values() const { return {data_, size_}; }

 private:
  detail::SharedStream stream_;
  U* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace pliant
