#pragma once

#include <cstdint>

#include <pliant/backend/atomic.hpp>
#include <pliant/config.hpp>

// Who makes what cells of a list share, where many of them are divided at once: the cell that comes first in the list. Until
// it is made, the number of what is missing, −1, is that cell's claim: its place in the list above the smallest number. So the
// least of a number, claims and −1, read without a sign, is the one that holds, and a thread need not look at what it claims.
namespace pliant::detail {

inline constexpr std::uint32_t first_claim = std::uint32_t{1} << 31;

/// For the cell at a place of the list. `shared`: whether several threads claim at once.
PLIANT_HOST_DEVICE void claim(Index& number, Index place, bool shared) {
  auto& own = reinterpret_cast<std::uint32_t&>(number);
  std::uint32_t const mine = first_claim + static_cast<std::uint32_t>(place);
  if (shared)
    atomic_min(own, mine);
  else if (mine < own)
    own = mine;
}
/// The place of the cell that has claimed a number.
PLIANT_HOST_DEVICE Index claimant(Index claimed) {
  return static_cast<Index>(static_cast<std::uint32_t>(claimed) - first_claim);
}
/// Whether it is that cell which makes it.
PLIANT_HOST_DEVICE bool makes(Index place, Index number) {
  return number < -1 && claimant(number) == place;
}
/// Takes a claim back, whosever it is.
PLIANT_HOST_DEVICE void give_up_claim(Index& number) {
  if (atomic_load(number) < -1) atomic_store(number, -1);
}

}  // namespace pliant::detail
