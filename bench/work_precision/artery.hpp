#pragma once

#include <numbers>

#include <pliant/pliant.hpp>

// A slice of an artery whose wall has two families of fibres, which wind around it with and against the axis.
namespace pliant::bench::artery {

/// m, of the wall at rest; of a rabbit's carotid artery (Holzapfel, Gasser and Ogden, Journal of Elasticity 61 (2000) 1),
/// as are the fibres' angle and the stiffnesses of `media`.
inline constexpr double inner = 1.43e-3, outer = 1.82e-3;
inline constexpr double angle = 29 * std::numbers::pi / 180;  // from the circumference
inline constexpr double density = 1.1e3;                      // kg/m³

/// The wall up to an angle, `cells` radially, around and along the axis. Boundaries: left and right are the
/// inner and the outer side, front and back where the angle is 0 and where it ends, bottom and top the ends of the axis.
template <Element E>
Mesh<E> wall(double around, double height, std::array<int, 3> const& cells) {
  auto mesh = mesh::box<E>(
      {.size = {outer - inner, around, height}, .cells = cells, .origin = {inner, 0, 0}});
  for (auto& p : mesh.nodes) p = {p[0] * std::cos(p[1]), p[0] * std::sin(p[1]), p[2]};
  return mesh;
}

/// The directions of both families at a place.
inline std::array<double, 6> fibres_at(Point<3> const& p) {
  double const r = std::hypot(p[0], p[1]), c = std::cos(angle), s = std::sin(angle);
  std::array const along{-p[1] / r, p[0] / r};
  return {c * along[0], c * along[1], s, c * along[0], c * along[1], -s};
}

/// The group of a formulation; under a law with fibres with those in the middles of the elements.
template <class F, class Law>
Group<F> group(Law const& law) {
  Group<F> group;
  if constexpr (requires { group.law = law; }) {
    group.law = law;
    if constexpr (element_values<F> > 0) group.values_at = fibres_at;
  }
  return group;
}

}  // namespace pliant::bench::artery
