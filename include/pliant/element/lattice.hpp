#pragma once

#include <pliant/element/quadratic_tensor.hpp>
#include <pliant/math/power.hpp>

namespace pliant {

/// The lattice of a tensor element: its nodes, or those of the Lagrange element of the same degree, direction 0 fastest.
template <TensorElement E>
struct Lattice {
  static constexpr int size = E::degree + 1;  // along a line
  static constexpr int count = power(size, E::dim);

  /// Where node a lies.
  PLIANT_HOST_DEVICE static constexpr int of_node(int a) {
    auto const place = E::place(a);
    int l = 0;
    for (int k = 0; k < E::dim; ++k)
      l += (place[k] > 0.5 ? size - 1 : place[k] < -0.5 ? 0 : 1) * power(size, k);
    return l;
  }
  /// The node at l; −1 where the element has none.
  PLIANT_HOST_DEVICE static constexpr int node_at(int l) {
    for (int a = 0; a < E::nodes; ++a)
      if (of_node(a) == l) return a;
    return -1;
  }
  /// The value at l of the shape function of node a.
  PLIANT_HOST_DEVICE static constexpr double shape(int l, int a) {
    Vector<double, E::dim> xi{};
    for (int k = 0; k < E::dim; ++k) xi[k] = 2.0 / E::degree * (l / power(size, k) % size) - 1;
    return E::shape(xi)[a];
  }
};

}  // namespace pliant
