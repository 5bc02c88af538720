#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include <pliant/config.hpp>

namespace pliant::detail {

template <class U>
struct CopyValue {
  U const* from;
  U* to;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to[i] = from[i]; }
};

/// Copies values in pieces that an Index can number.
template <class B, class U>
void copy_values(B const& backend, U const* from, U* to, std::size_t count) {
  constexpr std::size_t most = std::numeric_limits<Index>::max();
  for (std::size_t first = 0; first < count; first += most)
    backend.for_each(static_cast<Index>(std::min(most, count - first)),
                     CopyValue<U>{from + first, to + first});
}

}  // namespace pliant::detail
