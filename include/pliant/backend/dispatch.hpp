#pragma once

#include <pliant/backend/backend.hpp>

namespace pliant {

/// Calls f(GroupNumber<tag>{}); does nothing for a tag that is no group.
template <int Groups, int G = 0, class F>
PLIANT_HOST_DEVICE void dispatch(Tag tag, F const& f) {
  if constexpr (G < Groups) {
    if (tag == G)
      f(GroupNumber<G>{});
    else
      dispatch<Groups, G + 1>(tag, f);
  }
}

}  // namespace pliant
