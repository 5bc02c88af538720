#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include <pliant/mesh/mesh.hpp>

namespace pliant {

/// What a change of topology means for fields: where new nodes, elements and facets come from. All numbers
/// are the user's. Nodes that stay keep their numbers; new ones follow. Values per element are taken
/// from the ancestor.
template <int Dim>
class Transfer {
 public:
  /// A new node, as a weighted sum over nodes that were there before it.
  struct NewNode {
    Index node;
    std::vector<std::pair<Index, double>> parents;  // (node, weight); weights add up to one
  };
  /// Where an element comes from: the number of an old element of the same type, and which of its
  /// children it is; −1: it is that element.
  struct Origin {
    Index element;
    int child;
  };

  /// How many nodes, and elements of each type, there were, and where the new ones come from.
  Transfer(Index old_nodes, std::vector<NewNode> new_nodes, std::vector<std::size_t> old_elements,
           std::vector<std::vector<Origin>> origins)
      : old_nodes_(old_nodes),
        new_nodes_(std::move(new_nodes)),
        old_elements_(std::move(old_elements)),
        origins_(std::move(origins)) {
    for (NewNode const& n : new_nodes_)
      if (n.parents.size() == 2)
        middles_[std::minmax(n.parents[0].first, n.parents[1].first)] = n.node;
  }

  Index old_nodes() const { return old_nodes_; }
  Index nodes() const { return old_nodes_ + static_cast<Index>(new_nodes_.size()); }
  std::vector<NewNode> const& new_nodes() const { return new_nodes_; }
  /// Of the elements of one type (its place among the mesh's), in the new order.
  std::vector<Origin> const& origins(std::size_t type = 0) const { return origins_[type]; }

  /// Values per node (numbers or points) on the new mesh: new nodes take the weighted sum. Throws Error for an
  /// array that is not of the mesh before.
  template <class V>
  std::vector<V> carry_nodes(std::vector<V> values) const {
    check(values.size(), static_cast<std::size_t>(old_nodes_), "nodes");
    values.reserve(static_cast<std::size_t>(nodes()));
    for (NewNode const& n : new_nodes_) {
      V sum{};
      for (auto const& [parent, weight] : n.parents)
        add(sum, weight, values[static_cast<std::size_t>(parent)]);
      values.push_back(sum);
    }
    return values;
  }
  /// Values per element of one type on the new mesh: `width` each, side by side. Throws Error as carry_nodes.
  template <class V>
  std::vector<V> carry_elements(std::vector<V> const& values, std::size_t type = 0,
                                std::size_t width = 1) const {
    check(values.size(), old_elements_[type] * width, "elements");
    std::vector<V> carried;
    carried.reserve(origins(type).size() * width);
    for (Origin const& origin : origins(type)) {
      auto const first = width * static_cast<std::size_t>(origin.element);
      for (std::size_t k = 0; k < width; ++k) carried.push_back(values[first + k]);
    }
    return carried;
  }
  /// Facets of the boundary on the new mesh: a facet that was split gives way to its parts, in their
  /// order along it.
  std::vector<Facet<Dim>> carry_facets(std::vector<Facet<Dim>> const& facets) const {
    std::vector<Facet<Dim>> carried;
    for (auto const& facet : facets) add_parts(facet, carried);
    return carried;
  }

 private:
  static void check(std::size_t got, std::size_t wanted, char const* what) {
    if (got != wanted)
      throw Error("transfer: got ", got, " values of ", what, ", but those before the change take ",
                  wanted, "; give the arrays from before it");
  }
  static void add(double& sum, double weight, double value) { sum += weight * value; }
  static void add(float& sum, double weight, float value) {
    sum += static_cast<float>(weight) * value;
  }
  template <class V, std::size_t N>
  static void add(std::array<V, N>& sum, double weight, std::array<V, N> const& value) {
    for (std::size_t k = 0; k < N; ++k) add(sum[k], weight, value[k]);
  }
  void add_parts(Facet<Dim> const& facet, std::vector<Facet<Dim>>& parts) const {
    auto const middle = middles_.find(std::minmax(facet[0], facet[1]));
    if (facet.size() != 2 || middle == middles_.end()) {
      parts.push_back(facet);
      return;
    }
    add_parts({facet[0], middle->second}, parts);
    add_parts({middle->second, facet[1]}, parts);
  }

  Index old_nodes_;
  std::vector<NewNode> new_nodes_;
  std::vector<std::size_t> old_elements_;  // by type
  std::vector<std::vector<Origin>> origins_;
  std::map<std::pair<Index, Index>, Index> middles_;  // of edges that were halved, by their ends
};

}  // namespace pliant
