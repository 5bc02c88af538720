#pragma once

#include <cstddef>
#include <memory>
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
  PinnedArray(detail::SharedStream stream, std::size_t count) : size_(count) {
    if (count == 0) return;
    auto const device = stream->enter();
    std::size_t const bytes = detail::array_bytes<U>(count);
    void* memory = nullptr;
    detail::check_memory(cudaMallocHost(&memory, bytes), bytes);
    memory_ = {static_cast<U*>(memory), Release{std::move(stream)}};
  }

  U* data() { return memory_.get(); }
  std::size_t size() const { return memory_ ? size_ : 0; }
  /// What kernels wrote before the stream was waited for the last time.
  std::span<U const> values() const { return {memory_.get(), size()}; }

 private:
  struct Release {
    detail::SharedStream stream;
    void operator()(U* memory) const noexcept {
      detail::DeviceGuard const device(stream->device(), std::nothrow);
      cudaStreamSynchronize(stream->get());  // kernels may still write
      cudaFreeHost(memory);
    }
  };

  std::unique_ptr<U, Release> memory_;
  std::size_t size_ = 0;
};

}  // namespace pliant
