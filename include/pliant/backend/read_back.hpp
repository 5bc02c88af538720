#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>

namespace pliant {

/// A few values that loops write and the host reads: of a backend with `pinned_array` in memory that both reach, so that
/// reading takes a wait and no copy. Loops should write each once, and read none.
template <Backend B, class U>
class ReadBack {
 public:
  ReadBack() = default;
  ReadBack(B const& backend, std::size_t count) : array_(made(backend, count)) {}

  [[nodiscard]] std::size_t size() const { return array_.size(); }
  [[nodiscard]] U* data() { return array_.data(); }
  /// Gives all the same value, while no loop may write them.
  void set_all(U const& value) {
    if constexpr (is_pinned)
      std::fill_n(array_.data(), size(), value);
    else
      array_.upload(std::vector<U>(size(), value));
  }
  /// The first values, as loops wrote them before the backend was waited for the last time.
  template <std::size_t N>
  [[nodiscard]] std::array<U, N> first() const {
    std::array<U, N> values;
    read(values);
    return values;
  }
  [[nodiscard]] std::vector<U> all() const {
    std::vector<U> values(size());
    read(values);
    return values;
  }

 private:
  static constexpr bool is_pinned =
      requires(B const& backend) { backend.template pinned_array<U>(std::size_t{}); };
  static auto made(B const& backend, std::size_t count) {
    if constexpr (is_pinned)
      return backend.template pinned_array<U>(count);
    else
      return zeros<U>(backend, count);
  }
  void read(std::span<U> values) const {
    if constexpr (is_pinned)
      std::copy_n(array_.values().begin(), values.size(), values.begin());
    else
      array_.download(values);
  }

  decltype(made(std::declval<B const&>(), std::size_t{})) array_;
};

}  // namespace pliant
