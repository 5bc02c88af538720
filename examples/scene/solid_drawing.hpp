#pragma once

#include <algorithm>
#include <cmath>

#include <pliant/mesh/sides.hpp>
#include <pliant/pliant.hpp>

#include "picture/strip.hpp"

namespace scene {

/// The visible ones of the facets of a deformed solid body's mesh, seen from the front, the right and above, without perspective; each
/// filled by colour(element), darker the more it looks away. Displacements are magnified.
template <pliant::Element E, class TheBody, class Colour>
std::vector<pliant::picture::Polygon> draw_solid(TheBody const& body,
                                                 std::vector<pliant::Facet<3>> const& facets,
                                                 double magnified, Colour const& colour) {
  using pliant::Index;
  using Point3 = pliant::Point<3>;
  auto const u = body.displacements();
  auto const at = [&](Index node) {
    auto p = body.mesh().nodes[static_cast<std::size_t>(node)];
    for (std::size_t k = 0; k < 3; ++k) p[k] += magnified * u[static_cast<std::size_t>(node)][k];
    return p;
  };
  // To the right, up, and towards the viewer.
  double const turn = -0.45, tilt = 0.42;
  Point3 const right{std::cos(turn), -std::sin(turn), 0},
      up{std::sin(turn) * std::sin(tilt), std::cos(turn) * std::sin(tilt), std::cos(tilt)},
      viewer{-std::sin(turn) * std::cos(tilt), -std::cos(turn) * std::cos(tilt), std::sin(tilt)};
  auto const along = [](Point3 const& axis, Point3 const& p) {
    return axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];
  };

  struct Side {
    double depth;
    pliant::picture::Polygon polygon;
  };
  std::vector<Side> sides;
  auto const outer = [&] {
    std::vector<std::array<Index, 4>> keys;
    for (auto const& facet : facets) keys.push_back(pliant::mesh::key_of(facet));
    std::ranges::sort(keys);
    return keys;
  }();
  auto const& elements = body.mesh().template elements<E>();
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (int s = 0; s < static_cast<int>(E::cell::sides().size()); ++s) {
      auto const facet = pliant::mesh::side_of<E>(elements[e], s);
      if (!std::ranges::binary_search(outer, pliant::mesh::key_of(facet))) continue;
      std::vector<Point3> corners;
      for (std::size_t c = 0; c < facet.corners(); ++c) corners.push_back(at(facet[c]));
      Point3 normal{}, middle{};
      for (std::size_t c = 0; c < corners.size(); ++c) {
        auto const &p = corners[c], &q = corners[(c + 1) % corners.size()];
        for (std::size_t k = 0; k < 3; ++k) {
          normal[k] += p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
          middle[k] += p[k] / static_cast<double>(corners.size());
        }
      }
      double const length = std::sqrt(along(normal, normal)),
                   facing = along(normal, viewer) / length;
      if (!(facing > 0)) continue;
      Side side{along(middle, viewer), {}};
      for (auto const& p : corners) side.polygon.corners.push_back({along(right, p), along(up, p)});
      auto fill = colour(e);
      double const light = 0.65 + 0.35 * facing;
      side.polygon.fill = {light * fill.r, light * fill.g, light * fill.b};
      sides.push_back(std::move(side));
    }
  std::ranges::stable_sort(sides, {}, &Side::depth);
  std::vector<pliant::picture::Polygon> polygons;
  for (auto& side : sides) polygons.push_back(std::move(side.polygon));
  return polygons;
}

}  // namespace scene
