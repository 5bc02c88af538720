#pragma once

#include <cstddef>

#include <pliant/backend/host_lists.hpp>
#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/math/unset_vector.hpp>

namespace pliant::detail {

/// Where what each of n has so many of begins in a list of all, and behind the last: (n + 1). count_of(i): how many. On the
/// threads of the host.
template <class CountOf>
UnsetVector<Index> first_of_each(Index n, CountOf const& count_of) {
  UnsetVector<Index> first(static_cast<std::size_t>(n) + 1);
  scan_in_parts(HostParts(n, Index{16384}), count_of, first.data());
  return first;
}

}  // namespace pliant::detail
