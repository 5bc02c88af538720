#pragma once

#include <pliant/config.hpp>

namespace pliant {

/// Which elements of a table each patch has: consecutive ones. Arrays are in the backend's memory.
struct PatchRanges {
  static constexpr Index run = 32;  ///< elements
  static constexpr Index runs(Index elements) { return elements / run + (elements % run != 0); }

  Index const* first = nullptr;   ///< (patches + 1), elements
  Index const* of_run = nullptr;  ///< (runs of elements): the patch of the first one
  Index size = 1;                 ///< how many elements a patch has at most

  PLIANT_HOST_DEVICE Index patch_of(Index e) const {
    Index patch = of_run[e / run];
    while (first[patch + 1] <= e) ++patch;
    return patch;
  }
};

}  // namespace pliant
