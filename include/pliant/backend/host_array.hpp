#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <new>
#include <span>
#include <utility>

#include <pliant/config.hpp>
#include <pliant/error.hpp>

namespace pliant {

/// The array of the backends that run on the host: owning and movable. It starts on a cache line, so
/// that a padded node never straddles two.
template <class U>
class HostArray {
 public:
  HostArray() = default;
  /// Zeroed.
  explicit HostArray(std::size_t count) : data_(allocate(count)), size_(count) {
    std::fill_n(data_, count, U(0));
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
    std::copy_n(values.data(), values.size(), data_);
  }
  /// Reads the first values.
  void download(std::span<U> values) const {
    check(values.size());
    std::copy_n(data_, values.size(), values.data());
  }

 private:
  static constexpr std::align_val_t line{64};

  static U* allocate(std::size_t count) {
    if (count > std::numeric_limits<std::ptrdiff_t>::max() / sizeof(U))
      throw Error("HostArray: an array of ", count,
                  " values is larger than memory; make a smaller mesh");
    return static_cast<U*>(::operator new(count * sizeof(U), line));
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
