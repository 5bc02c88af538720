#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <initializer_list>

#include <pliant/config.hpp>
#include <pliant/error.hpp>

namespace pliant {

/// A list of N items at most, which takes no memory beside its own.
template <class T, std::size_t N>
class ShortList {
 public:
  static constexpr std::size_t capacity = N;

  ShortList() = default;
  /// Throws Error for more than N.
  ShortList(std::initializer_list<T> items) : count_(items.size()) {
    if (items.size() > N)
      throw Error("list: got ", items.size(), " items where ", N, " are the most; give fewer");
    std::ranges::copy(items, items_.begin());
  }
  /// There must be fewer than N.
  PLIANT_HOST_DEVICE void push_back(T const& item) {
    assert(count_ < N);
    items_[count_++] = item;
  }

  [[nodiscard]] PLIANT_HOST_DEVICE std::size_t size() const { return count_; }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  PLIANT_HOST_DEVICE T const& operator[](std::size_t i) const { return items_[i]; }
  T const& back() const { return items_[count_ - 1]; }
  T* begin() { return items_.data(); }
  T* end() { return items_.data() + count_; }
  T const* begin() const { return items_.data(); }
  T const* end() const { return items_.data() + count_; }

 private:
  std::array<T, N> items_{};
  std::size_t count_ = 0;
};

}  // namespace pliant
