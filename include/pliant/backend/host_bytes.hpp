#pragma once

#include <cstddef>
#include <cstring>
#include <new>
#include <utility>

#include <pliant/backend/host_threads.hpp>
#include <pliant/error.hpp>

namespace pliant::detail {

/// Memory of the host: owning and movable, from the beginning of a cache line on. What is large is written by several
/// threads.
class HostBytes {
 public:
  HostBytes() = default;
  /// Not written yet. Throws Error when memory runs out.
  explicit HostBytes(std::size_t size) : data_(::operator new(size, line, std::nothrow)) {
    if (data_ == nullptr)
      throw Error("out of memory: an array of ", size,
                  " bytes was asked for; use a coarser mesh or single precision");
  }
  ~HostBytes() { ::operator delete(data_, line); }
  HostBytes(HostBytes&& other) noexcept : data_(std::exchange(other.data_, nullptr)) {}
  HostBytes& operator=(HostBytes&& other) noexcept {
    std::swap(data_, other.data_);
    return *this;
  }

  void* data() const { return data_; }
  /// Writes zeros.
  void clear(std::size_t size) {
    in_parts(size, [&](std::size_t first, std::size_t last, int) {
      std::memset(static_cast<std::byte*>(data_) + first, 0, last - first);
    });
  }
  /// To the bytes from `begin` on.
  void copy_from(void const* from, std::size_t size, std::size_t begin) {
    in_parts(size, [&](std::size_t first, std::size_t last, int) {
      std::memcpy(static_cast<std::byte*>(data_) + begin + first,
                  static_cast<std::byte const*>(from) + first, last - first);
    });
  }

 private:
  static constexpr std::align_val_t line{64};

  static void in_parts(std::size_t size, FunctionRef<void(std::size_t, std::size_t, int)> f) {
    constexpr std::size_t few = 1 << 20;  // written by one thread
    if (size > 0) HostParts{size, few}(f);
  }

  void* data_ = nullptr;
};

}  // namespace pliant::detail
