#pragma once

#include <pliant/law/law.hpp>

namespace pliant::detail {

/// v / |v|, and 0 where v is.
template <class S>
PLIANT_HOST_DEVICE Vector<S, 3> normalised(Vector<S, 3> const& v) {
  S const size = norm(v);
  return select(S(0) < size, S(1), S(0)) / select(S(0) < size, size, S(1)) * v;
}

}  // namespace pliant::detail
