#pragma once

#include <pliant/config.hpp>

namespace pliant {

/// Leaves that a coarsening merged, in the place of their parent.
struct MergedFamily {
  Index cell = -1;          ///< the parent, by its new number
  Index place = -1;         ///< and its place now
  Index first_before = -1;  ///< the place of its first child before; the others followed it
  Index children = 0;       ///< how many these were
};

}  // namespace pliant
