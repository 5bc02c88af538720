#pragma once

#include <span>
#include <vector>

#include <pliant/mesh/morton.hpp>

namespace pliant {

/// The order in which a body keeps nodes and elements, invisible to the user: elements along a
/// Morton curve, nodes in the order in which these elements first touch them.
template <Element... Es>
struct Numbering {
  std::vector<Index> internal_node;                     // by the user's number
  std::vector<Index> user_node;                         // by the internal number
  std::tuple<std::vector<Connectivity<Es>>...> tables;  // internal elements of internal nodes
  std::array<std::vector<Index>, sizeof...(Es)> user_element;  // by the internal number

  explicit Numbering(Mesh<Es...> const& mesh) : internal_node(mesh.nodes.size(), -1) {
    user_node.reserve(mesh.nodes.size());
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (number<I, Es>(mesh), ...);
    }(std::index_sequence_for<Es...>());
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)  // nodes of no element come last
      if (internal_node[i] < 0) take(static_cast<Index>(i));
  }

 private:
  Index take(Index user) {
    auto& number = internal_node[static_cast<std::size_t>(user)];
    if (number < 0) {
      number = static_cast<Index>(user_node.size());
      user_node.push_back(user);
    }
    return number;
  }

  template <std::size_t I, Element E>
  void number(Mesh<Es...> const& mesh) {
    auto const& elements = mesh.template elements<E>();
    std::vector<Point<E::dim>> centres(elements.size());
    for (std::size_t e = 0; e < elements.size(); ++e) {
      centres[e].fill(0);
      for (Index node : elements[e])
        for (std::size_t k = 0; k < E::dim; ++k)
          centres[e][k] += mesh.nodes[static_cast<std::size_t>(node)][k] / E::nodes;
    }
    user_element[I] = morton_order(std::span<Point<E::dim> const>(centres));
    auto& table = std::get<I>(tables);
    table.reserve(elements.size());
    for (Index e : user_element[I]) {
      Connectivity<E> nodes = elements[static_cast<std::size_t>(e)];
      for (Index& node : nodes) node = take(node);
      table.push_back(nodes);
    }
  }
};

}  // namespace pliant
