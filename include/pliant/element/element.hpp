#pragma once

#include <array>
#include <concepts>

#include <pliant/element/cell.hpp>
#include <pliant/math/dual.hpp>

namespace pliant {

/// How the mass of an element goes to its nodes such that every share is positive.
enum class Lumping {
  row_sum,  ///< ∫ N_a dV: linear elements
  nodal,    ///< Gauss-Lobatto quadrature, whose points are the nodes: Quad9, Hex27
  diagonal  ///< in proportion to ∫ N_a² dV (Hinton, Rock, Zienkiewicz 1976), where row sums fail
};

/// A cell with its shape functions N_a(ξ), constexpr, in any scalar. Nodes come as the cell's corners,
/// then one per edge, one per side (in 3D) and one in the middle, as far as the element has them.
template <class E>
concept Element = requires(Vector<double, E::dim> const& xi) {
  typename E::cell;
  requires E::cell::dim == E::dim;
  { E::shape(xi) } -> std::same_as<Vector<double, E::nodes>>;
  { E::degree } -> std::convertible_to<int>;
  { E::lumping } -> std::convertible_to<Lumping>;
  { E::name() } -> std::convertible_to<char const*>;
};

/// What elements have in common. Derive yours from it: a cell, a number of nodes, the degree.
template <class Cell, int Nodes, int Degree, Lumping How = Lumping::row_sum>
struct ElementOn {
  using cell = Cell;
  static constexpr int dim = Cell::dim, nodes = Nodes, degree = Degree;
  static constexpr Lumping lumping = How;
  static constexpr auto edges() { return Cell::edges(); }  // pairs of corners

  /// Where node a lies on the cell.
  PLIANT_HOST_DEVICE static constexpr Vector<double, dim> place(int a) {
    constexpr auto edges = Cell::edges();
    constexpr auto sides = Cell::sides();
    if (a < Cell::corners) return Cell::corner(a);
    std::size_t k = static_cast<std::size_t>(a - Cell::corners);
    if (k < edges.size()) return middle(edges[k]);
    k -= edges.size();
    if (dim == 3 && k < sides.size()) return middle(sides[k]);
    auto sum = Vector<double, dim>::zero();
    for (int b = 0; b < Cell::corners; ++b) sum = sum + Cell::corner(b);
    return 1.0 / Cell::corners * sum;
  }

 private:
  template <std::size_t N>
  PLIANT_HOST_DEVICE static constexpr Vector<double, dim> middle(
      std::array<int, N> const& corners) {
    auto sum = Vector<double, dim>::zero();
    int count = 0;
    for (int b : corners)
      if (b >= 0) {
        sum = sum + Cell::corner(b);
        ++count;
      }
    return 1.0 / count * sum;
  }
};

/// The linear function of corner b of the cell at node a.
template <Element E>
PLIANT_HOST_DEVICE constexpr Matrix<double, E::nodes, E::cell::corners> linear_at_nodes() {
  Matrix<double, E::nodes, E::cell::corners> values{};
  for (int a = 0; a < E::nodes; ++a) {
    auto const shape = E::cell::linear(E::place(a));
    for (int b = 0; b < E::cell::corners; ++b) values(a, b) = shape[b];
  }
  return values;
}

/// ∂N_a/∂ξ_k, by automatic differentiation of the shape functions.
template <Element E>
PLIANT_HOST_DEVICE constexpr Matrix<double, E::nodes, E::dim> shape_gradient(
    Vector<double, E::dim> const& xi) {
  using Variable = Dual<double, E::dim>;
  Vector<Variable, E::dim> variables{};
  for (int k = 0; k < E::dim; ++k) variables[k] = Variable::variable(xi[k], k);
  auto const shape = E::shape(variables);
  Matrix<double, E::nodes, E::dim> gradient{};
  for (int a = 0; a < E::nodes; ++a)
    for (int k = 0; k < E::dim; ++k) gradient(a, k) = shape[a].derivative[k];
  return gradient;
}

/// One value per node of an element and direction: coordinates, displacements, forces.
template <class E, class S>
using Nodal = Matrix<S, E::nodes, E::dim>;  // (nodes, dim)

/// The numbers of an element's nodes.
template <class E>
using Connectivity = std::array<Index, E::nodes>;

}  // namespace pliant
