#pragma once

#include <algorithm>
#include <cstddef>
#include <new>
#include <span>
#include <utility>

#include <pliant/backend/array_bytes.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/error.hpp>

namespace pliant {

/// The array of the backends that run on the host: owning and movable. It starts on a cache line, so
/// that a padded node never straddles two.
template <class U>
class HostArray {
 public:
  HostArray() = default;
  /// Zeroed. Throws Error when memory runs out.
  explicit HostArray(std::size_t count) : data_(allocate(count)), size_(count) {
    detail::HostParts{count, few_bytes / sizeof(U)}([&](std::size_t first, std::size_t last, int) {
      std::fill(data_ + first, data_ + last, U{});
    });
  }
  /// With values, which are copied. Throws Error when memory runs out.
  explicit HostArray(std::span<U const> values)
      : data_(allocate(values.size())), size_(values.size()) {
    upload(values);
  }
  /// Of values that are still to be written: they are not set. Throws Error when memory runs out.
  static HostArray unset(std::size_t count) {
    HostArray array;
    array.data_ = allocate(count);
    array.size_ = count;
    return array;
  }
  ~HostArray() { ::operator delete(data_, line); }
  HostArray(HostArray&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  HostArray& operator=(HostArray&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }

  U* data() { return data_; }
  U const* data() const { return data_; }
  std::size_t size() const { return size_; }
  /// Overwrites the first values.
  void upload(std::span<U const> values) {
    check(values.size());
    detail::HostParts{values.size(),
                      few_bytes / sizeof(U)}([&](std::size_t first, std::size_t last, int) {
      std::copy(values.data() + first, values.data() + last, data_ + first);
    });
  }
  /// Reads the first values.
  void download(std::span<U> values) const {
    check(values.size());
    std::copy_n(data_, values.size(), values.data());
  }

 private:
  static constexpr std::align_val_t line{64};
  static constexpr std::size_t few_bytes = 1 << 20;  // written by one thread

  static U* allocate(std::size_t count) {
    std::size_t const bytes = detail::array_bytes<U>(count);
    void* const data = ::operator new(bytes, line, std::nothrow);
    if (data == nullptr)
      throw Error("out of memory: an array of ", bytes,
                  " bytes was asked for; use a coarser mesh or single precision");
    return static_cast<U*>(data);
  }
  void check(std::size_t count) const {
    if (count > size())
      throw Error("HostArray: copy of ", count, " values, but the array holds ", size(),
                  "; make the array larger");
  }

  U* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace pliant
