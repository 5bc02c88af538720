#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

#include <pliant/backend/array_bytes.hpp>
#include <pliant/backend/host_bytes.hpp>
#include <pliant/config.hpp>
#include <pliant/error.hpp>

namespace pliant {

/// The array of the backends that run on the host: owning and movable. It starts on a cache line, so
/// that a padded node never straddles two.
template <class U>
class HostArray {
  static_assert(std::is_trivially_copyable_v<U>, "arrays of backends hold plain values");

 public:
  HostArray() = default;
  /// Zeroed. Throws Error when memory runs out.
  explicit HostArray(std::size_t count) : HostArray(unset(count)) {
    bytes_.clear(count * sizeof(U));
  }
  /// With values, which are copied. Throws Error when memory runs out.
  explicit HostArray(std::span<U const> values) : HostArray(unset(values.size())) {
    upload(values);
  }
  /// Of values that are still to be written: they are not set, and in a program with assertions no value that is of use.
  /// Throws Error when memory runs out.
  static HostArray unset(std::size_t count) {
    HostArray array;
    array.bytes_ = detail::HostBytes(detail::array_bytes<U>(count));
    array.size_ = count;
#if !defined(NDEBUG)
    if (count > 0) std::memset(array.bytes_.data(), 0xa5, count * sizeof(U));
#endif
    return array;
  }
  HostArray(HostArray&& other) noexcept
      : bytes_(std::move(other.bytes_)), size_(std::exchange(other.size_, 0)) {}
  HostArray& operator=(HostArray&& other) noexcept {
    std::swap(bytes_, other.bytes_);
    std::swap(size_, other.size_);
    return *this;
  }

  U* data() { return static_cast<U*>(bytes_.data()); }
  U const* data() const { return static_cast<U const*>(bytes_.data()); }
  std::size_t size() const { return size_; }
  /// Overwrites the values from `first` on.
  void upload(std::span<U const> values, std::size_t first = 0) {
    check(first, values.size());
    bytes_.copy_from(values.data(), values.size_bytes(), first * sizeof(U));
  }
  /// Reads the first values.
  void download(std::span<U> values) const {
    check(0, values.size());
    std::copy_n(data(), values.size(), values.data());
  }

 private:
  void check(std::size_t first, std::size_t count) const {
    if (first > size() || count > size() - first)
      throw Error("HostArray: copy of ", count, " values from ", first, " on, but the array holds ",
                  size(), "; make the array larger");
  }

  detail::HostBytes bytes_;
  std::size_t size_ = 0;
};

}  // namespace pliant
