#include "draw_frame.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "style.hpp"

namespace pliant::picture {

using namespace style;

namespace {

Point add(Point a, Point b, double factor) { return {a[0] + factor * b[0], a[1] + factor * b[1]}; }

double dot(Point a, Point b) { return a[0] * b[0] + a[1] * b[1]; }

double distance(Point a, Point b) { return std::hypot(b[0] - a[0], b[1] - a[1]); }

// The shorter way across an element, roughly: what its edges must not fill.
double measure_thickness(std::vector<Point> const& corners) {
  double area = 0;
  double longest = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    auto const a = add(corners[i], corners[0], -1);  // small numbers, for the sake of rounding
    auto const b = add(corners[(i + 1) % corners.size()], corners[0], -1);
    area += (a[0] * b[1] - a[1] * b[0]) / 2;
    longest = std::max(longest, distance(a, b));
  }
  return longest > 0 ? std::abs(area) / longest : 0;
}

void draw_edges(Canvas& canvas, std::vector<Point> const& corners) {
  double const thickness = measure_thickness(corners);
  double const width = edge_part * thickness * std::min(thickness / fading_element, 1.0);
  if (width > thinnest_edge) canvas.stroke(corners, ink, std::min(width, thickest_edge));
}

void draw_polygons(Canvas& canvas, Frame const& frame, View const& view) {
  std::vector<std::vector<Point>> mapped(frame.polygons.size());
  for (std::size_t i = 0; i < mapped.size(); ++i) {
    auto const& [corners, colour] = frame.polygons[i];
    for (auto const& p : corners) mapped[i].push_back(view(p));
    canvas.fill(mapped[i], colour);
    // Two antialiased neighbours let the white between them through: overlap them.
    canvas.stroke(mapped[i], colour, 0.5);
    if (frame.layers == Layers::stacked) draw_edges(canvas, mapped[i]);
  }
  if (frame.layers == Layers::flat)
    for (auto const& corners : mapped) draw_edges(canvas, corners);
}

// Where the element behind a facet lies: the ground is on the other side.
Point find_inside(Point facet_centre, std::vector<Polygon> const& polygons, View const& view) {
  Point nearest = facet_centre;
  double least = std::numeric_limits<double>::max();
  for (auto const& polygon : polygons) {
    Point centre{0, 0};
    for (auto const& p : polygon.corners) {
      centre = add(centre, view(p), 1 / static_cast<double>(polygon.corners.size()));
    }
    if (distance(centre, facet_centre) < least) {
      least = distance(centre, facet_centre);
      nearest = centre;
    }
  }
  return nearest;
}

void draw_clamp(Canvas& canvas, Point from, Point to, Point outward) {
  Point const along{-outward[1], outward[0]};
  // Hatches sit at multiples of their spacing along the line, so that facets in line agree.
  double const begin = std::min(dot(from, along), dot(to, along));
  double const end = std::max(dot(from, along), dot(to, along));
  for (double k = std::ceil(begin / hatch_spacing); k * hatch_spacing <= end; ++k) {
    Point const root = add(from, along, k * hatch_spacing - dot(from, along));
    Point const tip = add(add(root, outward, hatch_depth), along, -hatch_depth);
    canvas.line(root, tip, ink, hatch_width);
  }
  canvas.line(from, to, ink, clamp_width);
}

void draw_clamps(Canvas& canvas, Frame const& frame, View const& view) {
  auto const is_end = [&](Point p) {
    return std::count_if(frame.clamps.begin(), frame.clamps.end(),
                         [&](Segment const& facet) { return facet[0] == p || facet[1] == p; }) == 1;
  };
  for (auto const& [from, to] : frame.clamps) {
    Point const a = view(from);
    Point const b = view(to);
    double const length = distance(a, b);
    if (length == 0) continue;
    Point const along{(b[0] - a[0]) / length, (b[1] - a[1]) / length};
    Point outward{along[1], -along[0]};
    Point const middle = add(a, along, length / 2);
    if (dot(outward, add(find_inside(middle, frame.polygons, view), middle, -1)) > 0) {
      outward = {-outward[0], -outward[1]};
    }
    draw_clamp(canvas, add(a, along, is_end(from) ? -hatch_spacing / 2 : 0),
               add(b, along, is_end(to) ? hatch_spacing / 2 : 0), outward);
  }
}

}  // namespace

void draw_frame(Canvas& canvas, Frame const& frame, View const& view) {
  for (auto const& [from, to] : frame.outline) {
    canvas.line(view(from), view(to), grey, outline_width);
  }
  draw_polygons(canvas, frame, view);
  draw_clamps(canvas, frame, view);
}

}  // namespace pliant::picture
