#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <pliant/mesh/mesh.hpp>

namespace pliant::mesh {

/// A mesh that was moved, in m.
template <Element... Es>
Mesh<Es...> moved(Mesh<Es...> mesh, Point<Mesh<Es...>::dim> const& by) {
  for (auto& place : mesh.nodes)
    for (std::size_t k = 0; k < by.size(); ++k) place[k] += by[k];
  return mesh;
}

/// Meshes beside each other as one, and which of it came from which: many bodies as one Body.
template <Element... Es>
struct Joined {
  static constexpr int dim = Mesh<Es...>::dim;

  Mesh<Es...> mesh;  // boundaries of one name are one boundary
  std::vector<Index> first_node{0};
  std::array<std::vector<Index>, sizeof...(Es)> first_element;  // by type

  std::size_t parts() const { return first_node.size() - 1; }
  /// What one part has of a named boundary of the mesh. Throws Error when there is no boundary of that name, or no part of that
  /// number.
  std::vector<Facet<dim>> boundary(std::size_t part, std::string const& name) const {
    if (part >= parts())
      throw Error("joined: there is no part ", part, "; they are numbered 0 to ", parts() - 1);
    std::vector<Facet<dim>> own;
    for (auto const& facet : mesh.boundary(name))
      if (first_node[part] <= facet[0] && facet[0] < first_node[part + 1]) own.push_back(facet);
    return own;
  }
};

/// Joins meshes that stand apart: parts that touch are not connected, and a node on another part's side is refused by the body, as
/// in any mesh. Nodes and elements stand in the order of the parts, which differ in nothing but their places and numbers.
/// Forces, steps, criteria and sleep of all parts then take one loop, or launch: small bodies are as fast as a large one. They
/// share the step, the energy check and the ledger. Throws Error where there are more nodes than Index can number.
template <Element... Es>
Joined<Es...> joined(std::span<Mesh<Es...> const> parts) {
  Joined<Es...> all;
  for (auto& first : all.first_element) first = {0};
  for (auto const& part : parts) {
    Index const before = all.first_node.back();
    if (part.nodes.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max() - before))
      throw Error("joined: part ", all.parts(),
                  " makes more nodes than Index can number; join fewer");
    auto const renumbered = [before](auto nodes) {
      for (Index& node : nodes) node += before;
      return nodes;
    };
    all.mesh.nodes.insert(all.mesh.nodes.end(), part.nodes.begin(), part.nodes.end());
    std::size_t type = 0;
    auto const add = [&]<Element E>(E) {
      auto& elements = all.mesh.template elements<E>();
      for (auto const& element : part.template elements<E>())
        elements.push_back(renumbered(element));
      all.first_element[type++].push_back(static_cast<Index>(elements.size()));
    };
    (add(Es{}), ...);
    for (auto const& [name, facets] : part.boundaries) {
      auto& boundary = all.mesh.boundaries[name];
      for (auto const& facet : facets) boundary.push_back(renumbered(facet));
    }
    for (Slave slave : part.slaves) {
      slave.node += before;
      for (auto& [master, weight] : slave.masters) master += before;
      all.mesh.slaves.push_back(std::move(slave));
    }
    all.first_node.push_back(static_cast<Index>(all.mesh.nodes.size()));
  }
  return all;
}
template <Element... Es>
Joined<Es...> joined(std::vector<Mesh<Es...>> const& parts) {
  return joined(std::span<Mesh<Es...> const>(parts));
}

}  // namespace pliant::mesh
