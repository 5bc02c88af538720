#pragma once

#include <algorithm>

#include <pliant/mesh/sides.hpp>
#include <pliant/pliant.hpp>

#include "picture/solid.hpp"

namespace scene {

/// Where the nodes of a solid body are, displacements magnified.
template <class TheBody>
std::vector<pliant::Point<3>> displaced(TheBody const& body, double magnified) {
  auto places = body.mesh().nodes;
  auto const u = body.displacements();
  for (std::size_t node = 0; node < places.size(); ++node)
    for (std::size_t k = 0; k < 3; ++k) places[node][k] += magnified * u[node][k];
  return places;
}

/// Those sides of a deformed solid body's elements that are facets of a list, such as a boundary of its mesh, which
/// follows refinement; each filled by colour(element). Displacements are magnified.
template <pliant::Element E, class TheBody, class Colour>
std::vector<pliant::picture::SolidFacet> solid_facets(TheBody const& body,
                                                      std::vector<pliant::Facet<3>> const& facets,
                                                      double magnified, Colour const& colour) {
  auto const places = displaced(body, magnified);
  std::vector<std::array<pliant::Index, 4>> listed;
  for (auto const& facet : facets) listed.push_back(pliant::mesh::key_of(facet));
  std::ranges::sort(listed);

  std::vector<pliant::picture::SolidFacet> found;
  auto const& elements = body.mesh().template elements<E>();
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (int s = 0; s < static_cast<int>(E::cell::sides().size()); ++s) {
      auto const side = pliant::mesh::side_of<E>(elements[e], s);
      if (!std::ranges::binary_search(listed, pliant::mesh::key_of(side))) continue;
      auto& facet = found.emplace_back(pliant::picture::SolidFacet{{}, colour(e)});
      for (std::size_t c = 0; c < side.corners(); ++c)
        facet.corners.push_back(places[static_cast<std::size_t>(side[c])]);
    }
  return found;
}

/// A picture of these facets.
template <pliant::Element E, class TheBody, class Colour>
pliant::picture::Frame draw_solid(TheBody const& body, std::vector<pliant::Facet<3>> const& facets,
                                  double magnified, Colour const& colour) {
  return {.polygons = pliant::picture::project(solid_facets<E>(body, facets, magnified, colour)),
          .layers = pliant::picture::Layers::stacked};
}

}  // namespace scene
