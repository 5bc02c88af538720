#pragma once

#include <pliant/mesh/outer_sides.hpp>
#include <pliant/pliant.hpp>

namespace scene {

/// A mesh without the elements whose middle lies where is_gone(Point) says so, nor the nodes of these alone. Its one boundary is its
/// "skin".
template <pliant::Element E, class IsGone>
pliant::Mesh<E> carve(pliant::Mesh<E> const& whole, IsGone const& is_gone) {
  pliant::Mesh<E> mesh;
  std::vector<pliant::Index> number(whole.nodes.size(), -1);
  for (auto element : whole.template elements<E>()) {
    pliant::Point<E::dim> middle{};
    for (pliant::Index node : element)
      for (std::size_t k = 0; k < E::dim; ++k)
        middle[k] += whole.nodes[static_cast<std::size_t>(node)][k] / E::nodes;
    if (is_gone(middle)) continue;
    for (pliant::Index& node : element) {
      auto& own = number[static_cast<std::size_t>(node)];
      if (own < 0) {
        own = static_cast<pliant::Index>(mesh.nodes.size());
        mesh.nodes.push_back(whole.nodes[static_cast<std::size_t>(node)]);
      }
      node = own;
    }
    mesh.template elements<E>().push_back(element);
  }
  mesh.boundaries["skin"] = pliant::mesh::outer_sides(mesh);
  return mesh;
}

}  // namespace scene
