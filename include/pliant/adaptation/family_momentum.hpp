#pragma once

#include <utility>
#include <vector>

#include <pliant/constraint/condition.hpp>
#include <pliant/element/linear.hpp>
#include <pliant/formulation/mass.hpp>
#include <pliant/topology/topology.hpp>

namespace pliant::detail {

/// The area that each node of a cell carries.
inline std::array<double, 4> nodal_areas(Hierarchy const& tree, HierarchyCell const& cell) {
  std::array<double, 4> areas{};
  auto const fill = [&]<Element E>(E) {
    Nodal<E, double> rest;
    for (std::size_t a = 0; a < E::nodes; ++a)
      for (std::size_t k = 0; k < 2; ++k)
        rest(static_cast<int>(a), static_cast<int>(k)) =
            tree.points()[static_cast<std::size_t>(cell.nodes[a])][k];
    auto const share = nodal_volumes<E>(rest);
    for (std::size_t a = 0; a < E::nodes; ++a) areas[a] = share[static_cast<int>(a)];
  };
  if (cell.sides == 3)
    fill(Tri3{});
  else
    fill(Quad4{});
  return areas;
}

/// The momentum that a cell carries, kg m/s, from velocities at nodes, less that of its mass moving
/// as one at the velocity `base`: where all do, what rounding left is no momentum.
inline Point<2> momentum(Hierarchy const& tree, HierarchyCell const& cell, double density,
                         std::vector<Point<2>> const& v, Point<2> const& base) {
  auto const areas = nodal_areas(tree, cell);
  Point<2> p{};
  for (std::size_t a = 0; a < static_cast<std::size_t>(cell.sides); ++a)
    for (std::size_t k = 0; k < 2; ++k)
      p[k] += density * areas[a] * (v[static_cast<std::size_t>(cell.nodes[a])][k] - base[k]);
  return p;
}

/// What each node must be given so that the family of a refined cell keeps its momentum: the
/// difference that lumping made, shared in proportion to the family's nodal masses.
inline void add_family_impulse(Hierarchy const& tree, Index parent, double density,
                               std::vector<Point<2>> const& v, std::vector<Point<2>>& impulse) {
  HierarchyCell const& cell = tree.cell(parent);
  Point<2> const base = v[static_cast<std::size_t>(cell.nodes[0])];
  Point<2> lost = momentum(tree, cell, density, v, base);
  double area = 0;
  for (Index c = cell.first_child; c < cell.first_child + 4; ++c) {
    Point<2> const p = momentum(tree, tree.cell(c), density, v, base);
    for (std::size_t k = 0; k < 2; ++k) lost[k] -= p[k];
    for (double a : nodal_areas(tree, tree.cell(c))) area += a;
  }
  for (Index c = cell.first_child; c < cell.first_child + 4; ++c) {
    auto const areas = nodal_areas(tree, tree.cell(c));
    for (std::size_t a = 0; a < static_cast<std::size_t>(cell.sides); ++a)
      for (std::size_t k = 0; k < 2; ++k)
        impulse[static_cast<std::size_t>(tree.cell(c).nodes[a])][k] += lost[k] * areas[a] / area;
  }
}

/// Gives each family of a refinement its momentum back by changing velocities; returns what held
/// nodes took of it, N s. Slaves hand their impulse to their masters. `held`: directions, by node.
template <class Layout, class M>
Point<2> give_momentum_back(Hierarchy const& tree, std::vector<Index> const& parents,
                            double density, Layout const& layout, Topology<M> const& topology,
                            std::vector<DirectionMask> const& held, std::vector<Point<2>>& v) {
  std::vector<Point<2>> impulse(v.size(), Point<2>{});
  for (Index parent : parents) add_family_impulse(tree, parent, density, v, impulse);
  topology.interpolation.apply_transpose(
      [&](Index i, int k) -> double& {
        return impulse[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
      },
      2);
  Point<2> taken{};
  for (std::size_t i = 0; i < v.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k)
      if (held[i] >> k & 1)
        taken[k] += impulse[i][k];
      else if (layout.mass_list[i] > 0)
        v[i][k] += impulse[i][k] / layout.mass_list[i];
  return taken;
}

}  // namespace pliant::detail
