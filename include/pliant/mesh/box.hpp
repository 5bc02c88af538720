#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>

#include <pliant/element/linear.hpp>
#include <pliant/mesh/raised.hpp>

namespace pliant::mesh {

/// What mesh::box fills.
struct BoxOptions {
  Point<3> size;             // m
  std::array<int, 3> cells;  // along x, y and z
  Point<3> origin{0, 0, 0};  // the lowest corner, m
};

namespace detail {

/// Six tetrahedra (Kuhn's split): one per path from the lowest to the highest corner along the axes.
inline std::array<Connectivity<Tet4>, 6> split_cell(Connectivity<Hex8> const& c, Tetrahedron) {
  return {{{c[0], c[1], c[2], c[6]},
           {c[0], c[3], c[7], c[6]},
           {c[0], c[4], c[5], c[6]},
           {c[0], c[5], c[1], c[6]},
           {c[0], c[7], c[4], c[6]},
           {c[0], c[2], c[3], c[6]}}};
}
/// Two wedges along z, beside the diagonal from the lowest corner.
inline std::array<Connectivity<Wedge6>, 2> split_cell(Connectivity<Hex8> const& c, Wedge) {
  return {{{c[0], c[1], c[2], c[4], c[5], c[6]}, {c[0], c[2], c[3], c[4], c[6], c[7]}}};
}
inline std::array<Connectivity<Hex8>, 1> split_cell(Connectivity<Hex8> const& c, Hexahedron) {
  return {c};
}

/// A box of cells: its nodes and elements in their order, x fastest; pyramids have their nodes in the middle of
/// cells behind all others.
template <Element E>
class BoxOfCells {
 public:
  explicit BoxOfCells(BoxOptions const& options) : o_(options) {}

  Mesh<E> mesh() const {
    Mesh<E> made;
    auto& elements = made.template elements<E>();
    made.nodes.resize(static_cast<std::size_t>(corners() + (has_middles ? cells() : 0)));
    elements.resize(static_cast<std::size_t>(cells()) * per_cell);
    pliant::detail::for_each_on_host(layers(), layers_of_a_part(), [&](Index k) {
      for (int j = 0; j <= o_.cells[1]; ++j)
        for (int i = 0; i <= o_.cells[0]; ++i) {
          made.nodes[static_cast<std::size_t>(corner(i, j, k))] = place({2 * i, 2 * j, 2 * k});
          if (i == o_.cells[0] || j == o_.cells[1] || k == o_.cells[2]) continue;
          Index const c = cell(i, j, k);
          if constexpr (has_middles)
            made.nodes[static_cast<std::size_t>(corners() + c)] =
                place({2 * i + 1, 2 * j + 1, 2 * k + 1});
          std::ranges::copy(elements_of({i, j, k}),
                            elements.begin() + static_cast<std::ptrdiff_t>(c) * per_cell);
        }
    });
    constexpr char const* names[3][2] = {{"left", "right"}, {"front", "back"}, {"bottom", "top"}};
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t end = 0; end < 2; ++end)
        made.boundaries[names[d][end]] = side(made, d, end == 1);
    return made;
  }

 private:
  static constexpr bool has_middles = std::same_as<typename E::cell, Pyramid>;
  static constexpr std::ptrdiff_t per_cell = std::same_as<typename E::cell, Tetrahedron> ? 6
                                             : has_middles                               ? 6
                                             : std::same_as<typename E::cell, Wedge>     ? 2
                                                                                         : 1;

  Index layers() const { return o_.cells[2] + 1; }
  Index layers_of_a_part() const { return 1 + 8192 / ((o_.cells[0] + 1) * (o_.cells[1] + 1)); }
  Index corners() const { return (o_.cells[0] + 1) * (o_.cells[1] + 1) * (o_.cells[2] + 1); }
  Index cells() const { return o_.cells[0] * o_.cells[1] * o_.cells[2]; }
  Index corner(int i, int j, int k) const {
    return (k * (o_.cells[1] + 1) + j) * (o_.cells[0] + 1) + i;
  }
  Index cell(int i, int j, int k) const { return (k * o_.cells[1] + j) * o_.cells[0] + i; }
  /// Of a node told in half cells.
  Point<3> place(std::array<int, 3> const& at) const {
    Point<3> p;
    for (std::size_t d = 0; d < 3; ++d)
      p[d] = o_.origin[d] + o_.size[d] * at[d] / (2 * o_.cells[d]);
    return p;
  }

  auto elements_of(std::array<int, 3> const& at) const {
    auto const [i, j, k] = at;
    Connectivity<Hex8> const c{corner(i, j, k),
                               corner(i + 1, j, k),
                               corner(i + 1, j + 1, k),
                               corner(i, j + 1, k),
                               corner(i, j, k + 1),
                               corner(i + 1, j, k + 1),
                               corner(i + 1, j + 1, k + 1),
                               corner(i, j + 1, k + 1)};
    if constexpr (has_middles) {
      std::array<Connectivity<E>, 6> pyramids;
      for (std::size_t s = 0; s < pyramids.size(); ++s) {
        auto const base = Hexahedron::sides()[s];
        auto const node = [&](std::size_t a) { return c[static_cast<std::size_t>(base[a])]; };
        pyramids[s] = {node(0), node(3), node(2), node(1), corners() + cell(i, j, k)};
      }
      return pyramids;
    } else {
      return split_cell(c, typename E::cell{});
    }
  }

  /// The sides of elements on one side of the box, in the order of their smallest corner.
  std::vector<Facet<3>> side(Mesh<E> const& made, std::size_t axis, bool at_end) const {
    std::vector<Facet<3>> found;
    std::vector<std::array<Index, 4>> order;  // the smallest corner, and the place in the list
    std::array<int, 3> first{0, 0, 0}, last = o_.cells;
    if (at_end) first[axis] = last[axis] - 1;
    last[axis] = first[axis] + 1;
    std::array<Index, 3> const stride{1, o_.cells[0] + 1, (o_.cells[0] + 1) * (o_.cells[1] + 1)};
    auto const is_here = [&](Index node) {
      return node < corners() &&
             node / stride[axis] % (o_.cells[axis] + 1) == (at_end ? o_.cells[axis] : 0);
    };
    auto const add = [&](Connectivity<E> const& element) {
      for (std::size_t s = 0; s < E::cell::sides().size(); ++s) {
        auto const facet = side_of<E>(element, static_cast<int>(s));
        if (!std::ranges::all_of(facet, is_here)) continue;
        order.push_back(
            {*std::min_element(facet.begin(), facet.end()), static_cast<Index>(found.size())});
        found.push_back(facet);
      }
    };
    for (int k = first[2]; k < last[2]; ++k)
      for (int j = first[1]; j < last[1]; ++j)
        for (int i = first[0]; i < last[0]; ++i)
          for (std::ptrdiff_t e = 0; e < per_cell; ++e)
            add(made.template elements<E>()[static_cast<std::size_t>(cell(i, j, k) * per_cell +
                                                                     e)]);
    std::sort(order.begin(), order.end());
    std::vector<Facet<3>> facets;
    facets.reserve(found.size());
    for (auto const& [smallest, place, none, unused] : order)
      facets.push_back(found[static_cast<std::size_t>(place)]);
    return facets;
  }

  BoxOptions const& o_;
};

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
  std::size_t nodes_of_elements = E::nodes * (TensorCell<Cell>            ? 1
                                              : std::same_as<Cell, Wedge> ? 2
                                                                          : 6);
  for (int const cells : o.cells) nodes_of_elements *= static_cast<std::size_t>(std::max(cells, 0));
  HostThreads const threads(HostThreads::worth(nodes_of_elements));
  if constexpr (E::degree > 1) {
    return raised<E>(box<Linear>(o));
  } else {
    bool sound = true;
    for (std::size_t k = 0; k < 3; ++k)
      sound = sound && o.cells[k] >= 1 && o.size[k] > 0 && std::isfinite(o.size[k]) &&
              std::isfinite(o.origin[k]);
    if (!sound)
      throw Error(
          "mesh::box: needs a positive, finite size, a finite origin, and at least one cell along "
          "each side");
    return detail::BoxOfCells<E>(o).mesh();
  }
}

}  // namespace pliant::mesh
