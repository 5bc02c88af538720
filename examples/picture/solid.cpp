#include "solid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "style.hpp"

namespace pliant::picture {

namespace {

double dot(Point3 const& a, Point3 const& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Point3 middle_of(SolidFacet const& facet) {
  Point3 middle{};
  for (auto const& p : facet.corners)
    for (std::size_t k = 0; k < 3; ++k)
      middle[k] += p[k] / static_cast<double>(facet.corners.size());
  return middle;
}

// Newell's sum: twice the area, also where the facet is bent. From the middle, for the sake of rounding.
Point3 normal_of(SolidFacet const& facet, Point3 const& middle) {
  Point3 normal{};
  for (std::size_t c = 0; c < facet.corners.size(); ++c) {
    Point3 p = facet.corners[c], q = facet.corners[(c + 1) % facet.corners.size()];
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] -= middle[k];
      q[k] -= middle[k];
    }
    for (std::size_t k = 0; k < 3; ++k)
      normal[k] += p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
  }
  return normal;
}

Colour shaded(Colour colour, double facing) {
  double const light = style::least_light + (1 - style::least_light) * facing;
  return {light * colour.r, light * colour.g, light * colour.b};
}

}  // namespace

Point Eye::project(Point3 const& p) const {
  double const back = std::sin(turn) * p[0] + std::cos(turn) * p[1];
  return {std::cos(turn) * p[0] - std::sin(turn) * p[1],
          std::sin(tilt) * back + std::cos(tilt) * p[2]};
}

Point3 Eye::towards() const {
  return {-std::sin(turn) * std::cos(tilt), -std::cos(turn) * std::cos(tilt), std::sin(tilt)};
}

double Eye::depth(Point3 const& p) const { return dot(towards(), p); }

std::vector<Polygon> project(std::span<SolidFacet const> facets, Eye const& eye) {
  std::vector<std::pair<double, Polygon>> seen;  // by depth
  for (auto const& facet : facets) {
    auto const middle = middle_of(facet);
    auto const normal = normal_of(facet, middle);
    double const facing = dot(normal, eye.towards()) / std::sqrt(dot(normal, normal));
    if (facing <= 0) continue;
    Polygon polygon{{}, shaded(facet.fill, facing)};
    for (auto const& p : facet.corners) polygon.corners.push_back(eye.project(p));
    seen.emplace_back(eye.depth(middle), std::move(polygon));
  }
  std::ranges::stable_sort(seen, {}, &std::pair<double, Polygon>::first);
  std::vector<Polygon> polygons;
  for (auto& [depth, polygon] : seen) polygons.push_back(std::move(polygon));
  return polygons;
}

Polygon arrow_down(Point tip, double length, Colour fill) {
  double const head = 0.4 * length, half_head = 0.22 * length, half_shaft = 0.08 * length;
  auto const at = [&](double x, double y) { return Point{tip[0] + x, tip[1] + y}; };
  return {{at(0, 0), at(half_head, head), at(half_shaft, head), at(half_shaft, length),
           at(-half_shaft, length), at(-half_shaft, head), at(-half_head, head)},
          fill};
}

}  // namespace pliant::picture
