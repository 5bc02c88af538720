#pragma once

#include <algorithm>
#include <new>
#include <span>
#include <string>
#include <vector>

#include <pliant/config.hpp>
#include <pliant/error.hpp>

namespace pliant {

namespace detail {
/// Starts every array on a cache line, so that a padded node never straddles two.
template <class U>
struct CacheLineAllocator {
  using value_type = U;
  static constexpr std::align_val_t line{64};

  CacheLineAllocator() = default;
  template <class V>
  CacheLineAllocator(CacheLineAllocator<V> const&) {}
  U* allocate(std::size_t n) { return static_cast<U*>(::operator new(n * sizeof(U), line)); }
  void deallocate(U* p, std::size_t) { ::operator delete(p, line); }
  friend bool operator==(CacheLineAllocator, CacheLineAllocator) { return true; }
};
}  // namespace detail

/// The array of the backends that run on the host.
template <class U>
class HostArray {
 public:
  HostArray() = default;
  explicit HostArray(std::size_t count) : values_(count) {}

  U* data() { return values_.data(); }
  U const* data() const { return values_.data(); }
  std::size_t size() const { return values_.size(); }
  /// Overwrites the first values.
  void upload(std::span<U const> values) {
    check(values.size());
    std::ranges::copy(values, values_.begin());
  }
  /// Reads the first values.
  void download(std::span<U> values) const {
    check(values.size());
    std::copy_n(values_.begin(), values.size(), values.begin());
  }

 private:
  void check(std::size_t count) const {
    if (count > size())
      throw Error("HostArray: copy of " + std::to_string(count) + " values, but the array holds " +
                  std::to_string(size()) + "; make the array larger");
  }

  std::vector<U, detail::CacheLineAllocator<U>> values_;
};

}  // namespace pliant
