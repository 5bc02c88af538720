#pragma once

#include <cmath>

#include <pliant/mesh/box.hpp>
#include <pliant/mesh/rectangle.hpp>

// Meshes of the unit square and cube whose lines lie closer together towards singular corners. Nodes
// between corners are in the middle, wherever the lines are.
namespace pliant::verification {

inline double evenly(double s) { return s; }

/// Lines towards 0: the first of n is at n^(−power).
inline auto towards_start(double power) {
  return [power](double s) { return std::pow(s, power); };
}
/// Lines towards 0 and 1.
inline auto towards_ends(double power) {
  return [power](double s) {
    return s < 0.5 ? std::pow(2 * s, power) / 2 : 1 - std::pow(2 - 2 * s, power) / 2;
  };
}

template <Element E>
using LinearOn = std::conditional_t<
    std::same_as<typename E::cell, Triangle>, Tri3,
    std::conditional_t<
        std::same_as<typename E::cell, Quadrilateral>, Quad4,
        std::conditional_t<std::same_as<typename E::cell, Tetrahedron>, Tet4, Hex8>>>;

/// Cells along each direction, and the function that places their lines, in [0, 1].
template <Element E, class... Place>
Mesh<E> graded(std::array<int, E::dim> const& cells, Place const&... place) {
  static_assert(sizeof...(Place) == E::dim);
  Mesh<LinearOn<E>> linear;
  if constexpr (E::dim == 2)
    linear = mesh::rectangle<LinearOn<E>>({.size = {1, 1}, .cells = cells});
  else
    linear = mesh::box<LinearOn<E>>({.size = {1, 1, 1}, .cells = cells});
  for (auto& p : linear.nodes) {
    std::size_t k = 0;
    ((p[k] = place(p[k]), ++k), ...);
  }
  if constexpr (E::degree > 1)
    return mesh::raised<E>(linear);
  else
    return linear;
}

}  // namespace pliant::verification
