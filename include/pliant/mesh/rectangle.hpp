#pragma once

#include <pliant/element/simplex.hpp>
#include <pliant/element/tensor.hpp>
#include <pliant/mesh/mesh.hpp>

namespace pliant::mesh {

struct RectangleOptions {
  Point<2> size;             // m
  std::array<int, 2> cells;  // along x and y
  Point<2> origin{0, 0};     // the lower left corner, m
};

/// A rectangle of Quad4 cells, or of Tri3 by splitting each cell (a, b, c, d), counter-clockwise from
/// its lower left corner, into (a, b, c) and (a, c, d). Boundaries: left, right, bottom, top.
template <Element E = Quad4>
Mesh<E> rectangle(RectangleOptions const& o) {
  auto const [nx, ny] = o.cells;
  if (nx < 1 || ny < 1 || !(o.size[0] > 0) || !(o.size[1] > 0))
    throw Error("mesh::rectangle: needs a positive size and at least one cell along each side");
  Mesh<E> mesh;
  auto const node = [nx = nx](int i, int j) { return Index{j * (nx + 1) + i}; };
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i)
      mesh.nodes.push_back({o.origin[0] + o.size[0] * i / nx, o.origin[1] + o.size[1] * j / ny});
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      Index const a = node(i, j), b = node(i + 1, j), c = node(i + 1, j + 1), d = node(i, j + 1);
      if constexpr (std::same_as<E, Quad4>) {
        mesh.template elements<E>().push_back({a, b, c, d});
      } else {
        static_assert(std::same_as<E, Tri3>, "mesh::rectangle makes Quad4 or Tri3 elements");
        mesh.template elements<E>().push_back({a, b, c});
        mesh.template elements<E>().push_back({a, c, d});
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

}  // namespace pliant::mesh
