#pragma once

#include <array>
#include <concepts>

#include <pliant/math/matrix.hpp>

// The reference shapes. Simplices have the corners 0 and the unit vectors; tensor cells are [−1, 1]ᵈ.
namespace pliant {

struct Triangle {
  static constexpr int dim = 2;
};
struct Quadrilateral {
  static constexpr int dim = 2;
};
struct Tetrahedron {
  static constexpr int dim = 3;
};
struct Hexahedron {
  static constexpr int dim = 3;
};

/// A cell with its shape functions: N_a(ξ) and ∂N_a/∂ξ_k, constexpr.
template <class E>
concept Element = requires(Vector<double, E::dim> const& xi) {
  typename E::cell;
  requires E::cell::dim == E::dim;
  { E::shape(xi) } -> std::same_as<Vector<double, E::nodes>>;
  { E::gradient(xi) } -> std::same_as<Matrix<double, E::nodes, E::dim>>;
  { E::sides() };  // node numbers of each side, outward (counter-clockwise seen from outside)
  { E::name() } -> std::convertible_to<char const*>;
};

/// An element whose shape functions are the barycentric coordinates: constant gradients.
template <class E>
concept LinearSimplex = Element<E> && E::nodes == E::dim + 1;

/// One value per node of an element and direction: coordinates, displacements, forces.
template <class E, class S>
using Nodal = Matrix<S, E::nodes, E::dim>;  // (nodes, dim)

/// The numbers of an element's nodes.
template <class E>
using Connectivity = std::array<Index, E::nodes>;

}  // namespace pliant
