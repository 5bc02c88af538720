#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <pliant/constraint/interpolation.hpp>
#include <pliant/mesh/mesh.hpp>
#include <pliant/topology/cell_set.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/hierarchy.hpp>

namespace pliant {

/// The cells of a body at one moment, in the user's order. Never changed: a refinement makes another. Behind the first
/// one, what has not changed is shared with the topology before it, and the mesh is made when it is asked for.
template <class M>
class Topology {
 public:
  static constexpr int dim = M::dim;
  /// A list that topologies share as long as no change touches it.
  using Facets = std::shared_ptr<std::vector<Facet<dim>> const>;

  Interpolation interpolation;                 ///< its hanging nodes
  std::shared_ptr<Hierarchy<dim> const> tree;  ///< null before the first refinement
  std::vector<CellSet> cells;  ///< per type: the cells of the tree that its elements are
  std::vector<std::vector<double>> element_values;  ///< per type: (elements, values) that laws read
  Index first_renumbered_cell =
      0;  ///< those before have the numbers that they had before the change of which it came

  Topology() = default;
  /// Of a mesh that nothing was done to.
  explicit Topology(M mesh) : interpolation(compose(mesh.slaves)), stored_(std::move(mesh)) {
    for (auto const& [name, facets] : stored_.boundaries)
      boundaries_.emplace(name, std::make_shared<std::vector<Facet<dim>> const>(facets));
  }
  /// Of the cells of a tree, per type.
  Topology(std::shared_ptr<Hierarchy<dim> const> of, std::vector<CellSet> cells_of_types)
      : interpolation(of->slave_rows()), tree(std::move(of)), cells(std::move(cells_of_types)) {}

  /// The elements that act. Of a tree, it takes a look at all of them, once.
  M const& mesh() const {
    if (!tree) return stored_;
    std::call_once(made_->once, [&] { make(made_->mesh); });
    return made_->mesh;
  }
  /// Its tree; of a mesh that nothing was done to one that is made, and shared for as long as somebody has it.
  [[nodiscard]] std::shared_ptr<Hierarchy<dim> const> tree_or_first() const {
    if (tree) return tree;
    std::scoped_lock const lock(made_->mutex);
    auto first = made_->first_tree.lock();
    if (!first) made_->first_tree = first = std::make_shared<Hierarchy<dim> const>(stored_);
    return first;
  }
  [[nodiscard]] Index nodes() const {
    return static_cast<Index>(tree ? tree->points().size() : stored_.nodes.size());
  }
  /// Where a node is at rest, m.
  [[nodiscard]] Point<dim> const& point(Index node) const {
    auto const i = static_cast<std::size_t>(node);
    return tree ? tree->points()[i] : stored_.nodes[i];
  }
  /// How many elements there are, by type.
  [[nodiscard]] std::vector<std::size_t> counts() const {
    if (!tree) return detail::element_counts(stored_);
    std::vector<std::size_t> list;
    for (auto const& own : cells) list.push_back(own.size());
    return list;
  }
  /// How many nodes elements have, each counted by each of them.
  [[nodiscard]] std::size_t connectivity_size() const {
    auto const elements = counts();
    std::size_t size = 0;
    detail::for_each_type_of<M>(
        [&]<Element E>(E, std::size_t type) { size += E::nodes * elements[type]; });
    return size;
  }
  /// The nodes of an element.
  template <Element E>
  [[nodiscard]] Connectivity<E> nodes_of(Index element) const {
    auto const e = static_cast<std::size_t>(element);
    if (!tree) return stored_.template elements<E>()[e];
    return nodes_of_cell<E>(cells[detail::type_in<E, M>][e]);
  }
  /// The nodes of the element that a cell of the tree is.
  template <Element E>
  [[nodiscard]] Connectivity<E> nodes_of_cell(Index c) const {
    Connectivity<E> nodes;
    if constexpr (nodes_on_cell<E> == CellNodes::corners) {
      std::copy_n(tree->tree().row(c).nodes, E::nodes, nodes.begin());
      if constexpr (E::nodes == 4)  // of tetrahedra alone
        if (tree->cell(c).mirrored) std::swap(nodes[2], nodes[3]);
    } else {
      std::ranges::copy(tree->tree().element_nodes(c), nodes.begin());
    }
    return nodes;
  }
  [[nodiscard]] std::map<std::string, Facets> const& boundaries() const { return boundaries_; }
  /// Takes carry(facets) of others, several at once on the threads of the host.
  template <class Carry>
  void set_boundaries(std::map<std::string, Facets> const& others, Carry const& carry) {
    std::vector<std::pair<Facets const*, Facets*>> lists;
    std::size_t count = 0;
    for (auto const& [name, facets] : others) {
      lists.emplace_back(&facets, &boundaries_[name]);
      count += facets->size();
    }
    Index const few = count < 65536 ? static_cast<Index>(lists.size()) : 1;  // worth a thread
    detail::for_each_on_host(static_cast<Index>(lists.size()), few, [&](Index i) {
      auto const& [from, to] = lists[static_cast<std::size_t>(i)];
      *to = carry(*from);
    });
  }

  template <class Visit, class... R>
  static void for_each_member(Visit const& visit, R&... r) {
    visit("mesh before the first refinement", r.stored_...);
    visit("named boundaries", r.boundaries_...);
    visit("hanging nodes", r.interpolation...);
    visit("refinement tree", r.tree...);
    visit("cells of elements", r.cells...);
    visit("values of elements", r.element_values...);
  }

 private:
  void make(M& mesh) const {
    mesh.nodes.reserve(tree->points().size());
    for (auto const& point : tree->points()) mesh.nodes.push_back(point);
    detail::for_each_type_of<M>([&]<Element E>(E, std::size_t type) {
      auto& elements = mesh.template elements<E>();
      elements.resize(cells[type].size());
      detail::HostParts const parts(static_cast<Index>(elements.size()),
                                    detail::few_elements(E::nodes));
      parts([&](Index from, Index to, int) {
        auto cell = cells[type].from(static_cast<std::size_t>(from));
        for (auto e = static_cast<std::size_t>(from); e < static_cast<std::size_t>(to); ++e)
          elements[e] = nodes_of_cell<E>(*cell++);
      });
    });
    for (auto const& [name, facets] : boundaries_) mesh.boundaries.emplace(name, *facets);
    mesh.slaves = detail::slaves_of(interpolation.slaves());
  }

  struct Made {
    std::once_flag once;
    M mesh;
    std::mutex mutex;
    std::weak_ptr<Hierarchy<dim> const> first_tree;
  };
  M stored_;  // with a tree: nothing
  std::map<std::string, Facets> boundaries_;
  std::shared_ptr<Made> made_ = std::make_shared<Made>();
};

/// The positions of an element's nodes: (nodes, dim).
template <std::size_t Nodes, class M>
auto nodal(Topology<M> const& topology, std::array<Index, Nodes> const& element) {
  return nodal<M::dim>(element, [&](Index node) -> auto& { return topology.point(node); });
}
/// The mean of an element's nodes, m.
template <std::size_t Nodes, class M>
Point<M::dim> mean_of_nodes(Topology<M> const& topology, std::array<Index, Nodes> const& element) {
  return mean_of_nodes<M::dim>(element, [&](Index node) -> auto& { return topology.point(node); });
}

namespace detail {

/// Calls visit(E{}, nodes) for an element, a Transfer's Member.
template <class M, class Member, class Visit>
void visit_member(Topology<M> const& topology, Member const& member, Visit const& visit) {
  for_each_type_of<M>([&]<Element E>(E element, std::size_t type) {
    if (type == member.type) visit(element, topology.template nodes_of<E>(member.element));
  });
}

}  // namespace detail

}  // namespace pliant
