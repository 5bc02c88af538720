#pragma once

#include <map>

#include <pliant/mesh/box.hpp>
#include <pliant/mesh/rectangle.hpp>

#include "support/random.hpp"

namespace pliant::test {

/// The linear element on the cell of another.
template <Element E>
using LinearOf = std::conditional_t<
    std::same_as<typename E::cell, Triangle>, Tri3,
    std::conditional_t<std::same_as<typename E::cell, Quadrilateral>, Quad4,
                       std::conditional_t<std::same_as<typename E::cell, Tetrahedron>, Tet4,
                                          std::conditional_t<E::degree == 1, E, Hex8>>>>;

/// A square or cube of edge 1 with n cells along x, n − 1 along the others, away from the origin.
template <Element E>
Mesh<E> regular_mesh(int n) {
  if constexpr (E::dim == 2)
    return mesh::rectangle<E>({.size = {1, 1}, .cells = {n, n - 1}, .origin = {-0.25, 0.5}});
  else
    return mesh::box<E>(
        {.size = {1, 1, 1}, .cells = {n, n - 1, n - 1}, .origin = {-0.25, 0.5, 0.125}});
}

template <class M>
std::vector<Index> boundary_nodes(M const& mesh) {
  std::vector<Facet<M::dim>> all;
  for (auto const& [name, facets] : mesh.boundaries)
    all.insert(all.end(), facets.begin(), facets.end());
  return nodes_of(all);
}
template <class M>
std::vector<Index> inner_nodes(M const& mesh) {
  std::vector<Index> const outer = boundary_nodes(mesh);
  std::vector<Index> inner;
  for (Index i = 0; i < static_cast<Index>(mesh.nodes.size()); ++i)
    if (!std::ranges::binary_search(outer, i)) inner.push_back(i);
  return inner;
}

/// Moves the inner nodes at random by at most `distance`, so that no two elements are alike.
template <class M>
M shaken(M mesh, double distance, unsigned seed = 1) {
  Random random(seed);
  double const reach = distance / std::sqrt(double{M::dim});
  for (Index i : inner_nodes(mesh))
    for (double& x : mesh.nodes[static_cast<std::size_t>(i)]) x += reach * random();
  return mesh;
}

/// Renumbers nodes and elements at random, as a mesh from elsewhere would be.
template <Element... Es>
Mesh<Es...> shuffled(Mesh<Es...> const& mesh, unsigned seed = 1) {
  Random random(seed);
  std::vector<Index> number(mesh.nodes.size());
  for (std::size_t i = 0; i < number.size(); ++i) number[i] = static_cast<Index>(i);
  random.shuffle(number);
  auto const renumber = [&](Index& node) {
    if (node >= 0) node = number[static_cast<std::size_t>(node)];
  };
  Mesh<Es...> other = mesh;
  for (std::size_t i = 0; i < number.size(); ++i)
    other.nodes[static_cast<std::size_t>(number[i])] = mesh.nodes[i];
  auto const mix = [&](auto& elements) {
    random.shuffle(elements);
    for (auto& element : elements)
      for (Index& node : element) renumber(node);
  };
  (mix(other.template elements<Es>()), ...);
  for (auto& [name, facets] : other.boundaries)
    for (auto& facet : facets)
      for (Index& node : facet) renumber(node);
  return other;
}

/// Irregular, and in no order: n cells along x, n − 1 along the others, inner nodes moved by a fifth
/// of a cell.
template <Element E>
Mesh<E> distorted_mesh(int n, unsigned seed = 1) {
  if constexpr (E::degree > 1)  // edges stay straight
    return shuffled(mesh::raised<E>(shaken(regular_mesh<LinearOf<E>>(n), 0.2 / n, seed)), seed);
  else
    return shuffled(shaken(regular_mesh<E>(n), 0.2 / n, seed), seed);
}

/// Triangles and quadrilaterals side by side, in one distorted square.
inline Mesh<Tri3, Quad4> mixed_mesh(int n, unsigned seed = 1) {
  auto const quads = shaken(regular_mesh<Quad4>(n), 0.2 / n, seed);
  Mesh<Tri3, Quad4> mesh;
  mesh.nodes = quads.nodes;
  mesh.boundaries = quads.boundaries;
  Random random(seed);
  for (auto const& q : quads.elements<Quad4>()) {
    if (random.below(2) == 0) {
      mesh.elements<Quad4>().push_back(q);
    } else {
      mesh.elements<Tri3>().push_back({q[0], q[1], q[2]});
      mesh.elements<Tri3>().push_back({q[0], q[2], q[3]});
    }
  }
  return shuffled(mesh, seed);
}

/// Some elements of a mesh, with their nodes alone.
template <Element E>
struct PartOfMesh {
  Mesh<E> mesh;
  std::vector<Index> nodes;  // in the whole mesh

  template <class M>
  PartOfMesh(M const& whole, std::vector<Index> const& members) {
    std::vector<Index> number(whole.nodes.size(), -1);
    for (Index e : members) {
      auto element = whole.template elements<E>()[static_cast<std::size_t>(e)];
      for (Index& node : element) {
        Index& own = number[static_cast<std::size_t>(node)];
        if (own < 0) {
          own = static_cast<Index>(nodes.size());
          nodes.push_back(node);
          mesh.nodes.push_back(whole.nodes[static_cast<std::size_t>(node)]);
        }
        node = own;
      }
      mesh.template elements<E>().push_back(element);
    }
  }
  /// The values at the part's nodes, and the way back.
  template <class V>
  std::vector<V> take(std::vector<V> const& values) const {
    std::vector<V> own;
    for (Index node : nodes) own.push_back(values[static_cast<std::size_t>(node)]);
    return own;
  }
  template <class V>
  std::vector<V> put(std::vector<V> const& own, std::size_t count) const {
    std::vector<V> values(count, V{});
    for (std::size_t i = 0; i < nodes.size(); ++i)
      values[static_cast<std::size_t>(nodes[i])] = own[i];
    return values;
  }
};

}  // namespace pliant::test
