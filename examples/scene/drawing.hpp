#pragma once

#include <pliant/pliant.hpp>

#include "picture/strip.hpp"

namespace scene {

/// The deformed elements of a plane body, filled by colour(element); held facets as ground.
template <pliant::Element E, class TheBody, class Colour>
pliant::picture::Frame draw(TheBody const& body, std::string caption, Colour const& colour) {
  pliant::picture::Frame frame;
  frame.caption = std::move(caption);
  auto const u = body.displacements();
  auto const at = [&](pliant::Index node) {
    auto p = body.mesh().nodes[static_cast<std::size_t>(node)];
    for (std::size_t k = 0; k < 2; ++k) p[k] += u[static_cast<std::size_t>(node)][k];
    return p;
  };
  auto const& elements = body.mesh().template elements<E>();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    pliant::picture::Polygon polygon;
    for (pliant::Index node : elements[e]) polygon.corners.push_back(at(node));
    polygon.fill = colour(e);
    frame.polygons.push_back(std::move(polygon));
  }
  for (auto const& condition : body.state().prescribed->conditions)
    for (auto const& facet : condition.facets) frame.clamps.push_back({at(facet[0]), at(facet[1])});
  return frame;
}

}  // namespace scene
