#pragma once

#include <cmath>

#include <pliant/element/linear.hpp>
#include <pliant/mesh/sides.hpp>

namespace pliant::mesh {

/// What mesh::box fills.
struct BoxOptions {
  Point<3> size;             // m
  std::array<int, 3> cells;  // along x, y and z
  Point<3> origin{0, 0, 0};  // the lowest corner, m
};

namespace detail {

/// Six tetrahedra (Kuhn's split): one per path from the lowest to the highest corner along the axes.
inline std::vector<Connectivity<Tet4>> split_cell(Connectivity<Hex8> const& c, Tet4) {
  return {{c[0], c[1], c[2], c[6]}, {c[0], c[3], c[7], c[6]}, {c[0], c[4], c[5], c[6]},
          {c[0], c[5], c[1], c[6]}, {c[0], c[7], c[4], c[6]}, {c[0], c[2], c[3], c[6]}};
}
/// Two wedges along z, beside the diagonal from the lowest corner.
inline std::vector<Connectivity<Wedge6>> split_cell(Connectivity<Hex8> const& c, Wedge6) {
  return {{c[0], c[1], c[2], c[4], c[5], c[6]}, {c[0], c[2], c[3], c[4], c[6], c[7]}};
}

}  // namespace detail

/// A box of hexahedra, or of cells that hexahedra are split into: six tetrahedra (Kuhn's split, along
/// the paths from the lowest to the highest corner), two wedges along z, or six pyramids around a node
/// in the middle; of any degree. Boundaries: left, right (x), front, back (y), bottom, top (z). Throws
/// Error for a size that is not positive and finite, an origin that is not finite, and no cells.
template <Element E = Hex8>
Mesh<E> box(BoxOptions const& o) {
  static_assert(E::dim == 3, "mesh::box makes solid elements; mesh::rectangle makes plane ones");
  using Cell = typename E::cell;
  using Linear = std::conditional_t<std::same_as<Cell, Tetrahedron>, Tet4,
                                    std::conditional_t<std::same_as<Cell, Hexahedron>, Hex8, E>>;
  if constexpr (E::degree > 1) {
    return raised<E>(box<Linear>(o));
  } else {
    auto const [nx, ny, nz] = o.cells;
    bool sound = nx >= 1 && ny >= 1 && nz >= 1;
    for (std::size_t k = 0; k < 3; ++k)
      sound = sound && o.size[k] > 0 && std::isfinite(o.size[k]) && std::isfinite(o.origin[k]);
    if (!sound)
      throw Error(
          "mesh::box: needs a positive, finite size, a finite origin, and at least one cell along "
          "each side");
    Mesh<E> mesh;
    auto& elements = mesh.template elements<E>();
    auto const node = [nx = nx, ny = ny](int i, int j, int k) {
      return Index{(k * (ny + 1) + j) * (nx + 1) + i};
    };
    std::vector<std::array<int, 3>> place;  // of each node, in half cells
    for (int k = 0; k <= nz; ++k)
      for (int j = 0; j <= ny; ++j)
        for (int i = 0; i <= nx; ++i) place.push_back({2 * i, 2 * j, 2 * k});
    for (int k = 0; k < nz; ++k)
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) {
          Connectivity<Hex8> const c{node(i, j, k),
                                     node(i + 1, j, k),
                                     node(i + 1, j + 1, k),
                                     node(i, j + 1, k),
                                     node(i, j, k + 1),
                                     node(i + 1, j, k + 1),
                                     node(i + 1, j + 1, k + 1),
                                     node(i, j + 1, k + 1)};
          if constexpr (std::same_as<Cell, Hexahedron>) {
            elements.push_back(c);
          } else if constexpr (std::same_as<Cell, Pyramid>) {
            auto const middle = static_cast<Index>(place.size());
            place.push_back({2 * i + 1, 2 * j + 1, 2 * k + 1});
            for (auto const& s : Hexahedron::sides()) {
              auto const at = [&](std::size_t a) { return c[static_cast<std::size_t>(s[a])]; };
              elements.push_back({at(0), at(3), at(2), at(1), middle});
            }
          } else {
            for (auto const& part : detail::split_cell(c, Linear{})) elements.push_back(part);
          }
        }
    std::array<int, 3> const ends{2 * nx, 2 * ny, 2 * nz};
    for (auto const& p : place) {
      mesh.nodes.emplace_back();
      for (std::size_t d = 0; d < 3; ++d)
        mesh.nodes.back()[d] = o.origin[d] + o.size[d] * p[d] / ends[d];
    }
    constexpr char const* names[3][2] = {{"left", "right"}, {"front", "back"}, {"bottom", "top"}};
    for (auto const& facet : outer_sides(mesh))
      for (std::size_t d = 0; d < 3; ++d)
        for (std::size_t end = 0; end < 2; ++end)
          if (std::ranges::all_of(facet, [&](Index n) {
                return place[static_cast<std::size_t>(n)][d] == (end ? ends[d] : 0);
              }))
            mesh.boundaries[names[d][end]].push_back(facet);
    return mesh;
  }
}

}  // namespace pliant::mesh
