#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include <pliant/backend/array_bytes.hpp>
#include <pliant/cuda/stream.hpp>

namespace pliant {

/// An owning, movable array in the memory of the device of the backend that made it. What copies to
/// and from it is queued on that backend's stream.
template <class U>
class DeviceArray {
 public:
  /// Without values; assign to it what a backend made.
  DeviceArray() = default;
  /// Zeroed, in the order of the stream. Throws Error when the device has not enough memory.
  DeviceArray(detail::SharedStream stream, std::size_t count)
      : stream_(std::move(stream)), size_(count) {
    if (count == 0) return;
    auto const device = stream_->enter();
    allocate();
    cudaError_t const status = cudaMemsetAsync(data_, 0, count * sizeof(U), stream_->get());
    if (status != cudaSuccess) release();
    detail::check(status, "cudaMemsetAsync");
  }
  /// Not set: all values are written before any is read. Throws Error when the device has not enough memory.
  static DeviceArray unset(detail::SharedStream stream, std::size_t count) {
    DeviceArray array;
    array.stream_ = std::move(stream);
    array.size_ = count;
    if (count == 0) return array;
    auto const device = array.stream_->enter();
    array.allocate();
    return array;
  }
  /// With values, which may go once this returns.
  DeviceArray(detail::SharedStream stream, std::span<U const> values)
      : stream_(std::move(stream)), size_(values.size()) {
    if (size_ == 0) return;
    auto const device = stream_->enter();
    allocate();
    cudaError_t const status = copy(values, 0);
    if (status != cudaSuccess) release();
    detail::check(status, "cudaMemcpyAsync");
  }
  ~DeviceArray() {
    if (data_ == nullptr) return;
    detail::DeviceGuard const device(stream_->device(), std::nothrow);
    release();
  }
  DeviceArray(DeviceArray&& other) noexcept
      : stream_(std::move(other.stream_)),
        data_(std::exchange(other.data_, nullptr)),
        size_(std::exchange(other.size_, 0)) {}
  DeviceArray& operator=(DeviceArray&& other) noexcept {
    std::swap(stream_, other.stream_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }

  U* data() { return data_; }
  U const* data() const { return data_; }
  std::size_t size() const { return size_; }

  /// Overwrites the values from `first` on, after all that was queued on the backend's stream before. What is given may go once
  /// this returns.
  void upload(std::span<U const> values, std::size_t first = 0) {
    if (!has_room(first, values.size())) return;
    auto const device = stream_->enter();
    detail::check(copy(values, first), "cudaMemcpyAsync");
  }
  /// Reads the first values, after all that was queued on the backend's stream before, and waits
  /// for it.
  void download(std::span<U> values) const {
    if (!has_room(0, values.size())) return;
    auto const device = stream_->enter();
    stream_->download(values.data(), data_, values.size_bytes());
  }

 private:
  static bool is_pinned(void const* memory) {
    cudaPointerAttributes attributes{};
    return cudaPointerGetAttributes(&attributes, memory) != cudaSuccess ||
           attributes.type != cudaMemoryTypeUnregistered;
  }
  void allocate() {
    std::size_t const bytes = detail::array_bytes<U>(size_);
    cudaError_t const status = stream_->allocate(&data_, bytes);
    if (status != cudaSuccess) data_ = nullptr;
    detail::check_memory(status, bytes);
  }
  void release() noexcept { stream_->release(data_, size_ * sizeof(U)); }
  cudaError_t copy(std::span<U const> values, std::size_t first) {
    cudaError_t const status = cudaMemcpyAsync(data_ + first, values.data(), values.size_bytes(),
                                               cudaMemcpyHostToDevice, stream_->get());
    // Pageable memory is read before cudaMemcpyAsync returns; what the program has pinned is read later.
    return status == cudaSuccess && is_pinned(values.data()) ? cudaStreamSynchronize(stream_->get())
                                                             : status;
  }
  /// Whether there is anything to copy. Throws Error where there is no room for it.
  bool has_room(std::size_t first, std::size_t count) const {
    if (first > size_ || count > size_ - first)
      throw Error("CUDA: copy of ", count, " values from ", first, " on, but the array holds ",
                  size_, "; make the array larger");
    return count > 0;
  }

  detail::SharedStream stream_;
  U* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace pliant
