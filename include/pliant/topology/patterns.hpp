#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include <pliant/config.hpp>
#include <pliant/element/cell.hpp>
#include <pliant/topology/pattern_maker.hpp>
#include <pliant/topology/refinement_pattern.hpp>

// The patterns by which cells are divided.
namespace pliant {

namespace detail {

template <class Cell, Division How = Division::refined>
inline constexpr RefinementPattern pattern = PatternMaker<Cell>::make(How);

inline constexpr std::array refinement_patterns{&pattern<Triangle>,    &pattern<Quadrilateral>,
                                                &pattern<Tetrahedron>, &pattern<Hexahedron>,
                                                &pattern<Wedge>,       &pattern<Pyramid>};
inline constexpr std::array split_patterns{&pattern<Quadrilateral, Division::diagonal_0>,
                                           &pattern<Quadrilateral, Division::diagonal_1>,
                                           &pattern<Quadrilateral, Division::four_triangles>,
                                           &pattern<Hexahedron, Division::six_pyramids>};
inline constexpr std::array split_patterns_of_pyramids{&pattern<Pyramid, Division::diagonal_0>,
                                                       &pattern<Pyramid, Division::diagonal_1>};

}  // namespace detail

/// By which a cell is divided, in a way that its kind can be.
PLIANT_HOST_DEVICE RefinementPattern const& pattern_of(CellKind kind,
                                                       Division division = Division::refined) {
  auto const split = static_cast<std::size_t>(division) - 1;
#ifdef __CUDA_ARCH__  // which has no addresses of what is on the host
  static constexpr RefinementPattern refined[]{
      detail::pattern<Triangle>,   detail::pattern<Quadrilateral>, detail::pattern<Tetrahedron>,
      detail::pattern<Hexahedron>, detail::pattern<Wedge>,         detail::pattern<Pyramid>};
  static constexpr RefinementPattern splits[]{
      detail::pattern<Quadrilateral, Division::diagonal_0>,
      detail::pattern<Quadrilateral, Division::diagonal_1>,
      detail::pattern<Quadrilateral, Division::four_triangles>,
      detail::pattern<Hexahedron, Division::six_pyramids>,
      detail::pattern<Pyramid, Division::diagonal_0>,
      detail::pattern<Pyramid, Division::diagonal_1>};
  if (division == Division::refined) return refined[static_cast<std::size_t>(kind)];
  return splits[split + (kind == CellKind::pyramid ? 4 : 0)];
#else
  if (division == Division::refined)
    return *detail::refinement_patterns[static_cast<std::size_t>(kind)];
  return kind == CellKind::pyramid ? *detail::split_patterns_of_pyramids[split]
                                   : *detail::split_patterns[split];
#endif
}

/// How many sides a cell has that are cells of the plane: none in the plane itself.
template <class Cell>
inline constexpr int sides_of = Cell::dim == 3 ? static_cast<int>(Cell::sides().size()) : 0;

/// Where a point of a child's element, on a `Child`, lies on its parent's. `mirrored`: whether the parent is.
template <class Child>
constexpr Vector<double, Child::dim> on_parent(Vector<double, Child::dim> const& xi,
                                               RefinementPattern const& parent, int child,
                                               bool mirrored = false) {
  auto const own = static_cast<std::size_t>(child);
  auto weight = Child::linear(xi);
  auto const swap = [](auto& v, int i, int j) {
    double const kept = v[i];
    v[i] = v[j];
    v[j] = kept;
  };
  // Mirrored elements have their last two corners in the other order, and so two coordinates.
  if constexpr (std::same_as<Child, Tetrahedron>)
    if (mirrored != parent.mirrored[own]) swap(weight, 2, 3);
  auto place = Vector<double, Child::dim>::zero();
  for (int a = 0; a < Child::corners; ++a) {
    auto const& corner =
        parent.place[static_cast<std::size_t>(parent.child[own][static_cast<std::size_t>(a)])];
    for (int k = 0; k < Child::dim; ++k)
      place[k] += weight[a] * corner[static_cast<std::size_t>(k)];
  }
  if constexpr (std::same_as<Child, Tetrahedron>)
    if (mirrored) swap(place, 1, 2);
  return place;
}

}  // namespace pliant
