#pragma once

#include <array>
#include <string>
#include <vector>

#include "colour.hpp"

namespace pliant::picture {

using Point = std::array<double, 2>;
using Segment = std::array<Point, 2>;

/// One element as it is now: its corners in order around it, at least three.
struct Polygon {
  std::vector<Point> corners;
  Colour fill;
};

/// Flat: no polygon hides an edge of another. Stacked: each hides what lies behind it, drawn before it.
enum class Layers { flat, stacked };

/// One picture of a strip. Lengths are the mesh's own, with y pointing up.
struct Frame {
  std::vector<Polygon> polygons{};
  std::string caption{};           ///< below the frame; wraps, and breaks at '\n'
  std::vector<Segment> clamps{};   ///< clamped facets: hatched ground on the side without elements
  std::vector<Segment> outline{};  ///< the body at rest: thin and grey, behind the elements
  Layers layers = Layers::flat;
};

}  // namespace pliant::picture
