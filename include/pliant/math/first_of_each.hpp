#pragma once

#include <cstddef>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/math/unset_vector.hpp>

namespace pliant::detail {

/// Where what each of n has so many of begins in a list of all, and behind the last: (n + 1). count_of(i): how many; it is called
/// twice, on the threads of the host.
template <class CountOf>
UnsetVector<Index> first_of_each(Index n, CountOf const& count_of) {
  HostParts const parts(n, Index{16384});
  std::vector<Index> before(static_cast<std::size_t>(parts.count()) + 1, 0);
  parts([&](Index from, Index to, int part) {
    Index count = 0;
    for (Index i = from; i < to; ++i) count += static_cast<Index>(count_of(i));
    before[static_cast<std::size_t>(part) + 1] = count;
  });
  for (std::size_t part = 1; part < before.size(); ++part) before[part] += before[part - 1];
  UnsetVector<Index> first(static_cast<std::size_t>(n) + 1);
  parts([&](Index from, Index to, int part) {
    Index next = before[static_cast<std::size_t>(part)];
    for (Index i = from; i < to; ++i) {
      first[static_cast<std::size_t>(i)] = next;
      next += static_cast<Index>(count_of(i));
    }
  });
  first.back() = before.back();
  return first;
}

}  // namespace pliant::detail
