#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

#include <pliant/backend/backend.hpp>

namespace pliant {

/// Values of the host that loops read once each. Of a backend with `pinned_array` few are copied to memory that both reach, which takes
/// less time than to copy them to the backend's, as is done with many. Where loops run in the host's memory they are not copied.
template <Backend B, class U>
class HostValues {
 public:
  /// For so many values in all, once no loop reads those before.
  void begin(B const& backend, std::size_t count) {
    used_ = 0;
    is_pinned_ = has_pinned && count <= most_pinned;
    auto const room = [&] { return std::max(count + count / 2, std::size_t{1024}); };
    if constexpr (has_pinned)
      if (is_pinned_ && pinned_.size() < count) pinned_ = backend.template pinned_array<U>(room());
    if constexpr (!is_there)
      if (!is_pinned_ && there_.size() < count) there_ = unset<U>(backend, room());
  }
  /// Where loops read some, which stay as they are until these loops are done.
  [[nodiscard]] U const* put([[maybe_unused]] std::span<U const> values) {
    if constexpr (is_there) return values.data();
    std::size_t const first = std::exchange(used_, used_ + values.size());
    if constexpr (has_pinned)
      if (is_pinned_) {
        std::ranges::copy(values, pinned_.data() + first);
        return pinned_.data() + first;
      }
    there_.upload(values, first);
    return there_.data() + first;
  }

 private:
  static constexpr std::size_t most_pinned = std::size_t{1} << 17;
  static constexpr bool has_pinned =
      requires(B const& backend) { backend.template pinned_array<U>(std::size_t{}); };
  static constexpr bool is_there =
      !has_pinned && std::same_as<typename B::template Array<U>, HostArray<U>>;
  static auto no_pinned() {
    if constexpr (has_pinned)
      return decltype(std::declval<B const&>().template pinned_array<U>(std::size_t{})){};
    else
      return 0;
  }

  decltype(no_pinned()) pinned_{};
  typename B::template Array<U> there_{};
  bool is_pinned_ = false;  // where they are
  std::size_t used_ = 0;
};

}  // namespace pliant
