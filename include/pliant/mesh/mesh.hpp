#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <pliant/constraint/slave.hpp>
#include <pliant/element/element.hpp>
#include <pliant/error.hpp>
#include <pliant/math/each_once.hpp>

namespace pliant {

/// A place, displacement, velocity or force in 2D or 3D.
template <int Dim>
using Point = std::array<double, Dim>;

/// One side of an element on the boundary: the numbers of its nodes, corners first, then those in
/// the middle of its edges, beginning behind corner 0, then one in its own middle; counter-clockwise
/// seen from outside, in 2D with the body on the left.
template <int Dim>
class Facet {
 public:
  static constexpr std::size_t capacity = Dim == 2 ? 3 : 9;

  template <std::convertible_to<Index>... I>
  constexpr Facet(I... nodes) : nodes_{static_cast<Index>(nodes)...}, count_(sizeof...(I)) {
    static_assert(sizeof...(I) <= capacity, "a facet has at most 3 nodes in 2D and 9 in 3D");
  }
  constexpr void push_back(Index node) { nodes_[count_++] = node; }

  constexpr std::size_t size() const { return count_; }
  constexpr Index operator[](std::size_t a) const { return nodes_[a]; }
  constexpr Index* begin() { return nodes_.data(); }
  constexpr Index* end() { return nodes_.data() + count_; }
  constexpr Index const* begin() const { return nodes_.data(); }
  constexpr Index const* end() const { return nodes_.data() + count_; }
  /// How many of the nodes are corners.
  constexpr std::size_t corners() const {
    return Dim == 2 ? 2 : count_ % 3 == 0 && count_ < 9 ? 3 : 4;
  }
  friend constexpr bool operator==(Facet const&, Facet const&) = default;

 private:
  std::array<Index, capacity> nodes_{};
  std::size_t count_ = 0;
};

/// Nodes at rest, and the elements of each type that join them. Plain data, in the user's order.
template <Element... Es>
struct Mesh {
  static constexpr int dim = std::tuple_element_t<0, std::tuple<Es...>>::dim;
  static_assert(((Es::dim == dim) && ...), "all elements of a mesh live in the same dimension");

  std::vector<Point<dim>> nodes;                        // m
  std::tuple<std::vector<Connectivity<Es>>...> tables;  // one list of elements per type
  std::map<std::string, std::vector<Facet<dim>>> boundaries{};
  std::vector<Slave>
      slaves{};  // nodes that hang between others, each after the slaves among its masters

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("nodes", r.nodes...);
    visit("elements", r.tables...);
    visit("boundaries", r.boundaries...);
    visit("slaves", r.slaves...);
  }
  template <Element E>
  std::vector<Connectivity<E>>& elements() {
    return std::get<std::vector<Connectivity<E>>>(tables);
  }
  template <Element E>
  std::vector<Connectivity<E>> const& elements() const {
    return std::get<std::vector<Connectivity<E>>>(tables);
  }
  /// The facets of a named part of the boundary. Throws Error when there is none of that name.
  std::vector<Facet<dim>> const& boundary(std::string const& name) const {
    auto const found = boundaries.find(name);
    if (found != boundaries.end()) return found->second;
    std::string known;
    for (auto const& [other, facets] : boundaries) known += (known.empty() ? "" : ", ") + other;
    throw Error("mesh: no boundary is called \"", name, "\"; there are: ", known);
  }
};

/// The positions of an element's nodes, which point_of(node) has: (nodes, dim).
template <int Dim, std::size_t Nodes, std::invocable<Index> PointOf>
auto nodal(std::array<Index, Nodes> const& element, PointOf const& point_of) {
  Matrix<double, int{Nodes}, Dim> rest;
  for (std::size_t a = 0; a < Nodes; ++a)
    for (int k = 0; k < Dim; ++k)
      rest(static_cast<int>(a), k) = point_of(element[a])[static_cast<std::size_t>(k)];
  return rest;
}
template <std::size_t Nodes, Element... Es>
auto nodal(Mesh<Es...> const& mesh, std::array<Index, Nodes> const& element) {
  return nodal<Mesh<Es...>::dim>(
      element, [&](Index node) -> auto& { return mesh.nodes[static_cast<std::size_t>(node)]; });
}

/// The mean of an element's nodes, which point_of(node) has, m.
template <int Dim, std::size_t Nodes, std::invocable<Index> PointOf>
Point<Dim> mean_of_nodes(std::array<Index, Nodes> const& element, PointOf const& point_of) {
  Point<Dim> mean{};
  for (Index const node : element)
    for (std::size_t k = 0; k < mean.size(); ++k)
      mean[k] += point_of(node)[k] / static_cast<double>(Nodes);
  return mean;
}
template <std::size_t Nodes, Element... Es>
Point<Mesh<Es...>::dim> mean_of_nodes(Mesh<Es...> const& mesh,
                                      std::array<Index, Nodes> const& element) {
  return mean_of_nodes<Mesh<Es...>::dim>(
      element, [&](Index node) -> auto& { return mesh.nodes[static_cast<std::size_t>(node)]; });
}

/// The nodes on some facets, ascending, each once.
template <int Dim>
std::vector<Index> nodes_of(std::vector<Facet<Dim>> const& facets) {
  std::vector<Index> nodes;
  for (auto const& facet : facets) nodes.insert(nodes.end(), facet.begin(), facet.end());
  if (nodes.empty()) return nodes;
  auto const [least, largest] = std::ranges::minmax(nodes);
  if (least < 0) return detail::each_once(std::move(nodes));  // who takes them refuses them
  return detail::each_once(std::move(nodes), static_cast<std::size_t>(largest) + 1);
}

}  // namespace pliant
