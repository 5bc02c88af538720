#pragma once

#include <cmath>

// Where the lines of a mesh go between 0 and 1, so that elements get small towards singular ends.
namespace pliant::verification {

/// Towards 0: the first of n lines is at n^(−power).
inline double towards_start(double s, double power) { return std::pow(s, power); }

/// Towards 0 and 1.
inline double towards_ends(double s, double power) {
  return s < 0.5 ? towards_start(2 * s, power) / 2 : 1 - towards_start(2 - 2 * s, power) / 2;
}

}  // namespace pliant::verification
