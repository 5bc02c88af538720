#pragma once

#include "support/backends.hpp"
#include "support/fields.hpp"

namespace pliant::test {

/// How far two runs of the same may differ: not by a bit on CPUs, by rounding on a GPU, whose
/// additions come in no fixed order.
inline constexpr double between_runs(double rounding) {
#if defined(__CUDACC__)
  return rounding;
#else
  return 0 * rounding;
#endif
}

}  // namespace pliant::test
