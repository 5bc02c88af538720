#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

#include <pliant/backend/backend.hpp>

namespace pliant {

/// Values of the host that loops read once each: of a backend with `pinned_array` copied to memory that both reach, which takes less
/// time than to copy them to the backend's; where loops run in the host's memory they are not copied.
template <Backend B, class U>
class HostValues {
 public:
  /// For so many values in all, once no loop reads those before.
  void begin(B const& backend, std::size_t count) {
    used_ = 0;
    if constexpr (!is_there)
      if (memory_.size() < count)
        memory_ = made(backend, std::max(count + count / 2, std::size_t{1024}));
  }
  /// Where loops read some, which stay as they are until these loops are done.
  [[nodiscard]] U const* put([[maybe_unused]] std::span<U const> values) {
    if constexpr (is_there) return values.data();
    std::size_t const first = std::exchange(used_, used_ + values.size());
    if constexpr (is_pinned)
      std::ranges::copy(values, memory_.data() + first);
    else if constexpr (!is_there)
      memory_.upload(values, first);
    return memory_.data() + first;
  }

 private:
  static constexpr bool is_pinned =
      requires(B const& backend) { backend.template pinned_array<U>(std::size_t{}); };
  static constexpr bool is_there =
      !is_pinned && std::same_as<typename B::template Array<U>, HostArray<U>>;

  static auto made(B const& backend, std::size_t count) {
    if constexpr (is_pinned)
      return backend.template pinned_array<U>(count);
    else
      return zeros<U>(backend, count);
  }

  decltype(made(std::declval<B const&>(), std::size_t{})) memory_;
  std::size_t used_ = 0;
};

}  // namespace pliant
