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

/// The values at listed places.
template <class U>
struct TakeListed {
  U const* from;
  Index const* places;
  U* to;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to[i] = from[places[i]]; }
};

/// Tells two numbers that lie apart.
struct TellBoth {
  Index const *first, *second;
  Index* told;  // (2)
  PLIANT_HOST_DEVICE void operator()(Index) const {
    told[0] = *first;
    told[1] = *second;
  }
};

template <class U>
struct ClearValue {
  U* values;
  PLIANT_HOST_DEVICE void operator()(Index i) const { values[i] = U(0); }
};

/// Calls piece(first, count) for pieces of `count` values that an Index can number.
template <class Piece>
void for_each_piece(std::size_t count, Piece const& piece) {
  constexpr std::size_t most = std::numeric_limits<Index>::max();
  for (std::size_t first = 0; first < count; first += most)
    piece(first, static_cast<Index>(std::min(most, count - first)));
}
/// Copies values.
template <class B, class U>
void copy_values(B const& backend, U const* from, U* to, std::size_t count) {
  for_each_piece(count, [&](std::size_t first, Index n) {
    backend.for_each(n, CopyValue<U>{from + first, to + first});
  });
}
/// Sets values to zero.
template <class B, class U>
void clear_values(B const& backend, U* values, std::size_t count) {
  for_each_piece(count, [&](std::size_t first, Index n) {
    backend.for_each(n, ClearValue<U>{values + first});
  });
}

}  // namespace pliant::detail
