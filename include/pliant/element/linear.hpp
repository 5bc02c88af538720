#pragma once

#include <pliant/element/element.hpp>

// The elements whose nodes are the corners of their cell. Line2 is the side of plane ones.
namespace pliant {

/// Shape functions that are one at a corner of the cell and zero at the others: the cell's `linear`.
template <class Cell>
struct LinearElement : ElementOn<Cell, Cell::corners, 1> {
  template <class S>
  PLIANT_HOST_DEVICE static constexpr auto shape(Vector<S, Cell::dim> const& xi) {
    return Cell::linear(xi);
  }
};

/// An element whose shape functions are the barycentric coordinates: constant gradients.
template <class E>
concept LinearSimplex = Element<E> && SimplexCell<typename E::cell> &&
                        std::derived_from<E, LinearElement<typename E::cell>>;
/// A tensor product of linear functions.
template <class E>
concept Multilinear = Element<E> && TensorCell<typename E::cell> &&
                      std::derived_from<E, LinearElement<typename E::cell>>;

struct Line2 : LinearElement<Segment> {
  static constexpr char const* name() { return "Line2"; }
};
struct Tri3 : LinearElement<Triangle> {
  static constexpr char const* name() { return "Tri3"; }
};
struct Quad4 : LinearElement<Quadrilateral> {
  static constexpr char const* name() { return "Quad4"; }
};
struct Tet4 : LinearElement<Tetrahedron> {
  static constexpr char const* name() { return "Tet4"; }
};
struct Hex8 : LinearElement<Hexahedron> {
  static constexpr char const* name() { return "Hex8"; }
};
struct Wedge6 : LinearElement<Wedge> {
  static constexpr char const* name() { return "Wedge6"; }
};
/// With rational shape functions, which have no gradient at the apex.
struct Pyramid5 : LinearElement<Pyramid> {
  static constexpr char const* name() { return "Pyramid5"; }
};

}  // namespace pliant
