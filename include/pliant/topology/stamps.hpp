#pragma once

#include <cstddef>

#include <pliant/backend/atomic.hpp>
#include <pliant/backend/backend.hpp>
#include <pliant/config.hpp>

namespace pliant::detail {

/// Whether a call is the first that gives an entry the stamp `now`.
PLIANT_HOST_DEVICE bool stamps_first(Index& stamp, Index now) {
  if (atomic_peek(stamp) == now) return false;
  Index seen = atomic_load(stamp);
  while (seen != now)
    if (atomic_exchange(stamp, seen, now)) return true;
  return false;
}

/// Entries that a loop lists, each once: those of which the stamp is not `now` yet.
struct ListOnce {
  Index* stamps;  // by entry
  Index now;
  Index* list;
  Index* count;

  /// Whether it lists an entry now.
  PLIANT_HOST_DEVICE bool operator()(Index entry) const {
    bool const is_first = stamps_first(stamps[entry], now);
    if (is_first) list[atomic_add(*count, 1)] = entry;
    return is_first;
  }
};

/// A number for each entry of a list, by which loops tell entries that were seen: those with the number of the last `begin`.
template <Backend B>
class Stamps {
 public:
  /// None of so many entries was seen.
  void begin(B const& backend, std::size_t count) {
    if (array_.size() < count) {
      array_ = zeros<Index>(backend, array_.size() == 0 ? count : count + count / 2);
      now_ = 0;
    }
    ++now_;
  }
  [[nodiscard]] Index* data() { return array_.data(); }
  [[nodiscard]] Index now() const { return now_; }

 private:
  typename B::template Array<Index> array_;
  Index now_ = 0;
};

}  // namespace pliant::detail
