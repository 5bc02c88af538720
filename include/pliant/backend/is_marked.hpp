#pragma once

#include <pliant/config.hpp>

namespace pliant::detail {

/// Which entries of an array are not zero, for select.
template <class U>
struct IsMarked {
  U const* marks;
  PLIANT_HOST_DEVICE bool operator()(Index i) const { return marks[i] != U{0}; }
};

}  // namespace pliant::detail
