#pragma once

#include <pliant/element/element.hpp>

namespace pliant {

/// Corners and the middles of edges: λ(2λ − 1) and 4 λ_i λ_j in barycentric coordinates.
template <SimplexCell Cell>
struct QuadraticSimplex : ElementOn<Cell, Cell::corners + static_cast<int>(Cell::edges().size()), 2,
                                    Lumping::diagonal> {
  using QuadraticSimplex::ElementOn::nodes;

  template <class S>
  PLIANT_HOST_DEVICE static constexpr Vector<S, nodes> shape(Vector<S, Cell::dim> const& xi) {
    constexpr auto edges = Cell::edges();
    auto const l = Cell::linear(xi);
    Vector<S, nodes> n{};
    for (int a = 0; a < Cell::corners; ++a) n[a] = l[a] * (2 * l[a] - 1);
    for (int a = Cell::corners; a < nodes; ++a) {
      auto const& edge = edges[static_cast<std::size_t>(a - Cell::corners)];
      n[a] = 4 * l[edge[0]] * l[edge[1]];
    }
    return n;
  }
};

/// Its sides may be curved; where they are straight, the map from the cell is linear.
template <class E>
concept CurvedSimplex = Element<E> && SimplexCell<typename E::cell> &&
                        std::derived_from<E, QuadraticSimplex<typename E::cell>>;

struct Tri6 : QuadraticSimplex<Triangle> {
  static constexpr char const* name() { return "Tri6"; }
};
struct Tet10 : QuadraticSimplex<Tetrahedron> {
  static constexpr char const* name() { return "Tet10"; }
};

}  // namespace pliant
