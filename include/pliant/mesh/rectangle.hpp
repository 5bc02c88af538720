#pragma once

#include <cmath>

#include <pliant/element/linear.hpp>
#include <pliant/mesh/raised.hpp>

namespace pliant::mesh {

/// What mesh::rectangle fills.
struct RectangleOptions {
  Point<2> size;             // m
  std::array<int, 2> cells;  // along x and y
  Point<2> origin{0, 0};     // the lower left corner, m
};

/// A rectangle of quadrilaterals, or of triangles by splitting each cell (a, b, c, d),
/// counter-clockwise from its lower left corner, into (a, b, c) and (a, c, d); of any degree.
/// Boundaries: left, right, bottom, top. Throws Error for a size that is not positive and finite, an origin
/// that is not finite, and no cells.
template <Element E = Quad4>
Mesh<E> rectangle(RectangleOptions const& o) {
  static_assert(E::dim == 2, "mesh::rectangle makes plane elements; mesh::box makes solid ones");
  constexpr bool splits = std::same_as<typename E::cell, Triangle>;
  using Linear = std::conditional_t<splits, Tri3, Quad4>;
  if constexpr (E::degree > 1) {
    return raised<E>(rectangle<Linear>(o));
  } else {
    auto const [nx, ny] = o.cells;
    bool sound = nx >= 1 && ny >= 1;
    for (std::size_t k = 0; k < 2; ++k)
      sound = sound && o.size[k] > 0 && std::isfinite(o.size[k]) && std::isfinite(o.origin[k]);
    if (!sound)
      throw Error(
          "mesh::rectangle: needs a positive, finite size, a finite origin, and at least one cell "
          "along each side");
    Mesh<E> mesh;
    auto const node = [nx = nx](int i, int j) { return Index{j * (nx + 1) + i}; };
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i)
        mesh.nodes.push_back({o.origin[0] + o.size[0] * i / nx, o.origin[1] + o.size[1] * j / ny});
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        Index const a = node(i, j), b = node(i + 1, j), c = node(i + 1, j + 1), d = node(i, j + 1);
        if constexpr (splits) {
          mesh.template elements<E>().push_back({a, b, c});
          mesh.template elements<E>().push_back({a, c, d});
        } else {
          mesh.template elements<E>().push_back({a, b, c, d});
        }
      }
    for (int i = 0; i < nx; ++i) {
      mesh.boundaries["bottom"].push_back({node(i, 0), node(i + 1, 0)});
      mesh.boundaries["top"].push_back({node(i + 1, ny), node(i, ny)});
    }
    for (int j = 0; j < ny; ++j) {
      mesh.boundaries["left"].push_back({node(0, j + 1), node(0, j)});
      mesh.boundaries["right"].push_back({node(nx, j), node(nx, j + 1)});
    }
    return mesh;
  }
}

}  // namespace pliant::mesh
