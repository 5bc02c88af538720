#pragma once

#include <array>
#include <span>
#include <vector>

#include "frame.hpp"

namespace pliant::picture {

using Point3 = std::array<double, 3>;

/// A facet of a solid as it is now: its corners counter-clockwise as seen from outside, at least three.
struct SolidFacet {
  std::vector<Point3> corners;
  Colour fill;
};

/// An axonometric view, z pointing up. Angles are in radians.
struct Eye {
  double turn = -0.45;  ///< about z, from the front, where y is smallest; negative: from the right
  double tilt = 0.42;   ///< above the horizontal

  Point project(Point3 const& p) const;
  double depth(Point3 const& p) const;  ///< the larger, the nearer to the viewer
  Point3 towards() const;               ///< of length 1, from the solid to the viewer
};

/// The facets that look at the viewer, from far to near by the depth of their middles, and darker the more they look
/// away. Facets that cut each other, or a large one close before a small one, may come in the wrong order.
std::vector<Polygon> project(std::span<SolidFacet const> facets, Eye const& eye = {});

/// An arrow that points down to a tip.
Polygon arrow_down(Point tip, double length, Colour fill);

}  // namespace pliant::picture
