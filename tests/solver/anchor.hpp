#pragma once

#include <pliant/math/functions.hpp>
#include <pliant/math/matrix.hpp>

namespace pliant::test {

/// A spring from where a node is at rest.
template <class T>
struct Anchor {
  static constexpr int nodes = 1, dim = 2;
  T stiffness;  // N/m
  template <class S>
  PLIANT_HOST_DEVICE S energy(Matrix<S, 1, 2> const&, Matrix<S, 1, 2> const& u) const {
    return stiffness / 2 * (square(u(0, 0)) + square(u(0, 1)));
  }
};

}  // namespace pliant::test
