#pragma once

#include <pliant/force/connected_term.hpp>

namespace pliant::test {

/// Pulls two nodes together, for ConnectedTerm.
template <class T>
struct Spring {
  static constexpr int nodes = 2, dim = 2;
  T stiffness;  // N/m
  template <class S>
  PLIANT_HOST_DEVICE S energy(Matrix<S, 2, 2> const&, Matrix<S, 2, 2> const& u) const {
    return stiffness / 2 * (square(u(1, 0) - u(0, 0)) + square(u(1, 1) - u(0, 1)));
  }
};

}  // namespace pliant::test
