#pragma once

#include <pliant/element/simplex.hpp>
#include <pliant/element/tensor.hpp>
#include <pliant/mesh/mesh.hpp>

namespace pliant::mesh {

struct BoxOptions {
  Point<3> size;             // m
  std::array<int, 3> cells;  // along x, y and z
  Point<3> origin{0, 0, 0};  // the lowest corner, m
};

/// A box of Hex8 cells, or of Tet4 by Kuhn's split of each cell: six tetrahedra, one per path from the
/// lowest to the highest corner along the axes. Boundaries: left, right (x), front, back (y), bottom,
/// top (z).
template <Element E = Hex8>
Mesh<E> box(BoxOptions const& o) {
  auto const [nx, ny, nz] = o.cells;
  if (nx < 1 || ny < 1 || nz < 1 || !(o.size[0] > 0) || !(o.size[1] > 0) || !(o.size[2] > 0))
    throw Error("mesh::box: needs a positive size and at least one cell along each side");
  Mesh<E> mesh;
  auto const node = [nx = nx, ny = ny](int i, int j, int k) {
    return Index{(k * (ny + 1) + j) * (nx + 1) + i};
  };
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i)
        mesh.nodes.push_back({o.origin[0] + o.size[0] * i / nx, o.origin[1] + o.size[1] * j / ny,
                              o.origin[2] + o.size[2] * k / nz});
  constexpr int paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  auto const add_facet = [&](char const* name, std::array<Index, 4> const& quad) {
    auto& facets = mesh.boundaries[name];
    if constexpr (std::same_as<E, Hex8>) {
      facets.push_back(quad);
    } else {  // Kuhn's diagonal runs from the lowest to the highest corner of the face
      auto const lowest = std::ranges::min_element(quad) - quad.begin();
      auto const at = [&](std::ptrdiff_t i) {
        return quad[static_cast<std::size_t>((lowest + i) % 4)];
      };
      facets.push_back({at(0), at(1), at(2), -1});
      facets.push_back({at(0), at(2), at(3), -1});
    }
  };
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        std::array<Index, 8> const c{node(i, j, k),
                                     node(i + 1, j, k),
                                     node(i + 1, j + 1, k),
                                     node(i, j + 1, k),
                                     node(i, j, k + 1),
                                     node(i + 1, j, k + 1),
                                     node(i + 1, j + 1, k + 1),
                                     node(i, j + 1, k + 1)};
        if constexpr (std::same_as<E, Hex8>) {
          mesh.template elements<E>().push_back(c);
        } else {
          static_assert(std::same_as<E, Tet4>, "mesh::box makes Hex8 or Tet4 elements");
          for (int p = 0; p < 6; ++p) {
            std::array<int, 3> at{i, j, k};
            std::array<Index, 4> t{c[0], 0, 0, 0};
            for (std::size_t s = 0; s < 3; ++s) {
              ++at[static_cast<std::size_t>(paths[p][s])];
              t[s + 1] = node(at[0], at[1], at[2]);
            }
            if (p >= 3) std::swap(t[1], t[2]);  // odd paths turn the other way
            mesh.template elements<E>().push_back(t);
          }
        }
        if (i == 0) add_facet("left", {c[0], c[4], c[7], c[3]});
        if (i == nx - 1) add_facet("right", {c[1], c[2], c[6], c[5]});
        if (j == 0) add_facet("front", {c[0], c[1], c[5], c[4]});
        if (j == ny - 1) add_facet("back", {c[3], c[7], c[6], c[2]});
        if (k == 0) add_facet("bottom", {c[0], c[3], c[2], c[1]});
        if (k == nz - 1) add_facet("top", {c[4], c[5], c[6], c[7]});
      }
  return mesh;
}

}  // namespace pliant::mesh
