#pragma once

#include <pliant/config.hpp>
#include <pliant/math/functions.hpp>
#include <pliant/math/uncontracted.hpp>

namespace pliant::detail {

/// Of four corners that run round, the one from 0 or 1 at which the shorter diagonal begins; of equal ones 0. coordinate(corner, k),
/// m.
template <int Dim, class Coordinate>
PLIANT_HOST_DEVICE int shorter_diagonal(Coordinate const& coordinate) {
  auto const length = [&](int corner) {
    Uncontracted square = 0.0;  // devices and hosts choose the same
    for (int k = 0; k < Dim; ++k) {
      Uncontracted const along = coordinate(corner + 2, k) - coordinate(corner, k);
      square += along * along;
    }
    return sqrt(square.value);
  };
  // What rounding tells apart is as long.
  return length(1) < (1 - 1e-12) * length(0) ? 1 : 0;
}

}  // namespace pliant::detail
