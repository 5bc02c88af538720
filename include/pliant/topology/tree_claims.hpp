#pragma once

#include <atomic>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>

// Who makes what cells of a list share, where several threads divide them: the cell that comes first in the list. Until
// it is made, the number of what is missing, −1, is that cell's claim: −2 − its place in the list.
namespace pliant::detail {

/// For the cell at a place of the list: several threads may claim at once.
inline void claim(Index& number, Index place) {
  Index const mine = -2 - place;
  auto const is_free = [&](Index seen) { return seen == -1 || seen < mine; };
  if (!HostThreads::in_loop()) {
    if (is_free(number)) number = mine;
    return;
  }
  std::atomic_ref const shared(number);
  Index seen = shared.load(std::memory_order_relaxed);
  while (is_free(seen) && !shared.compare_exchange_weak(seen, mine, std::memory_order_relaxed)) {
  }
}
/// Whether it is that cell which makes it.
inline bool makes(Index place, Index number) { return number == -2 - place; }
/// Takes a claim back, whosever it is.
inline void give_up_claim(Index& number) {
  std::atomic_ref const shared(number);
  if (shared.load(std::memory_order_relaxed) < -1) shared.store(-1, std::memory_order_relaxed);
}

}  // namespace pliant::detail
