#pragma once

#include <pliant/element/linear.hpp>

namespace pliant {

/// Nodes at −1, 0, 1 in each direction: products of the Lagrange polynomials of degree two.
template <TensorCell Cell>
struct QuadraticLagrange : ElementOn<Cell,
                                     Cell::dim == 1   ? 3
                                     : Cell::dim == 2 ? 9
                                                      : 27,
                                     2, Lumping::nodal> {
  using QuadraticLagrange::ElementOn::nodes;

  template <class S>
  PLIANT_HOST_DEVICE static constexpr Vector<S, nodes> shape(Vector<S, Cell::dim> const& xi) {
    Vector<S, nodes> n{};
    for (int a = 0; a < nodes; ++a) {
      auto const at = QuadraticLagrange::place(a);
      n[a] = S(1);
      for (int k = 0; k < Cell::dim; ++k) {
        S const& x = xi[k];
        n[a] = n[a] * (at[k] < 0 ? x * (x - 1) / 2 : at[k] > 0 ? x * (x + 1) / 2 : 1 - x * x);
      }
    }
    return n;
  }
};

/// Corners and the middles of edges (serendipity; Ergatoudis, Irons and Zienkiewicz, International Journal of
/// Solids and Structures 4 (1968) 31).
template <TensorCell Cell>
struct Serendipity : ElementOn<Cell, Cell::corners + static_cast<int>(Cell::edges().size()), 2,
                               Lumping::diagonal> {
  using Serendipity::ElementOn::nodes;

  template <class S>
  PLIANT_HOST_DEVICE static constexpr Vector<S, nodes> shape(Vector<S, Cell::dim> const& xi) {
    Vector<S, nodes> n{};
    for (int a = 0; a < nodes; ++a) {
      auto const at = Serendipity::place(a);
      S reach = S(1 - Cell::dim);  // Σ ξ_k ξ_ak − (d − 1)
      n[a] = S(1);
      for (int k = 0; k < Cell::dim; ++k) {
        bool const between = at[k] * at[k] < 0.5;
        n[a] = n[a] * (between ? 1 - xi[k] * xi[k] : (1 + at[k] * xi[k]) / 2);
        reach = reach + at[k] * xi[k];
      }
      if (a < Cell::corners) n[a] = n[a] * reach;
    }
    return n;
  }
};

/// An element on a segment, square or cube whose shape functions have its degree, at most, in each direction.
template <class E>
concept TensorElement =
    Element<E> && TensorCell<typename E::cell> &&
    (Multilinear<E> || std::derived_from<E, QuadraticLagrange<typename E::cell>> ||
     std::derived_from<E, Serendipity<typename E::cell>>);

struct Line3 : QuadraticLagrange<Segment> {
  static constexpr char const* name() { return "Line3"; }
};
struct Quad9 : QuadraticLagrange<Quadrilateral> {
  static constexpr char const* name() { return "Quad9"; }
};
struct Hex27 : QuadraticLagrange<Hexahedron> {
  static constexpr char const* name() { return "Hex27"; }
};
struct Quad8 : Serendipity<Quadrilateral> {
  static constexpr char const* name() { return "Quad8"; }
};
struct Hex20 : Serendipity<Hexahedron> {
  static constexpr char const* name() { return "Hex20"; }
};

}  // namespace pliant
