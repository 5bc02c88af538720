#pragma once

#include <pliant/backend/atomic.hpp>
#include <pliant/config.hpp>

// Who makes what cells of a list share, where many of them are divided at once: the cell that comes first in the list. Until
// it is made, the number of what is missing, −1, is that cell's claim: −2 − its place in the list.
namespace pliant::detail {

/// For the cell at a place of the list. `shared`: whether several threads claim at once.
PLIANT_HOST_DEVICE void claim(Index& number, Index place, bool shared) {
  Index const mine = -2 - place;
  auto const is_free = [&](Index seen) { return seen == -1 || seen < mine; };
  if (!shared) {
    if (is_free(number)) number = mine;
    return;
  }
  Index seen = atomic_load(number);
  while (is_free(seen) && !atomic_exchange(number, seen, mine)) {
  }
}
/// Whether it is that cell which makes it.
PLIANT_HOST_DEVICE bool makes(Index place, Index number) { return number == -2 - place; }
/// Takes a claim back, whosever it is.
PLIANT_HOST_DEVICE void give_up_claim(Index& number) {
  if (atomic_load(number) < -1) atomic_store(number, -1);
}

}  // namespace pliant::detail
