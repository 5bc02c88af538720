#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>
#include <vector>

#include <pliant/backend/carry_rows.hpp>
#include <pliant/body/touched_elements.hpp>
#include <pliant/math/each_once.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/topology.hpp>
#include <pliant/topology/transfer.hpp>

// Fields of nodes from one layout to another: most values stay and go over in the backend's memory; on the host are those
// that a change of topology looks at.
namespace pliant::detail {

/// Some nodes of a mesh, by the user's numbers, ascending.
struct NodeSubset {
  std::vector<Index> nodes;
  std::vector<Index> places;  // the inverse, by node; −1: not among them

  NodeSubset(std::vector<Index> some, std::size_t of_all)
      : nodes(each_once(std::move(some), of_all)), places(of_all, -1) {
    for (std::size_t k = 0; k < nodes.size(); ++k)
      places[static_cast<std::size_t>(nodes[k])] = static_cast<Index>(k);
  }
};

/// Values at these nodes, by the node's number.
template <class V>
struct ValuesAt {
  NodeSubset const* subset;
  std::vector<V> values;

  explicit ValuesAt(NodeSubset const& of) : subset(&of), values(of.nodes.size()) {}
  V& operator[](std::size_t node) { return values[place(node)]; }
  V const& operator[](std::size_t node) const { return values[place(node)]; }

 private:
  std::size_t place(std::size_t node) const {
    assert(subset->places[node] >= 0);
    return static_cast<std::size_t>(subset->places[node]);
  }
};

/// Takes fields of nodes over to another topology.
template <class Parts>
class CarriedNodes {
  static constexpr int dim = Parts::dim;
  using T = typename Parts::T;
  using Array = typename Parts::template Array<T>;
  using M = typename Parts::mesh_type;

 public:
  using Values = ValuesAt<Point<dim>>;

  CarriedNodes(Parts const& parts, Topology<M> const& after, Transfer<dim> const& transfer,
               TouchedElements<M> const& touched)
      : parts_(parts),
        transfer_(transfer),
        old_numbers_(transfer.old_numbers()),
        before_(nodes_before(*parts.state.topology, after, touched), old_node_count()),
        after_(nodes_after(), static_cast<std::size_t>(transfer.nodes())) {
    std::vector<Index> places;
    places.reserve(before_.nodes.size());
    for (Index const node : before_.nodes) places.push_back(parts.layout.internal_of(node));
    places_before_ = upload(parts.backend, places);
  }

  /// The nodes that it looks at, by their new numbers, ascending.
  std::vector<Index> const& looked_at() const { return after_.nodes; }

  /// The values before the change that it looks at.
  Values before(Array const& field) const {
    auto const count = static_cast<Index>(before_.nodes.size());
    auto rows = zeros<T>(parts_.backend, node_stride * before_.nodes.size());
    parts_.backend.for_each(count, TakeRows<T, dim>{node_field<dim>(field), node_field<dim>(rows),
                                                    places_before_.data()});
    Values values(before_);
    auto const& on = on_host<T>(std::as_const(rows));
    for (std::size_t i = 0; i < before_.nodes.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k)
        values.values[i][k] = static_cast<double>(on[node_stride * i + k]);
    return values;
  }
  /// The same after it, as the transfer has them.
  Values after(Values const& before) const {
    Values values(after_);
    for (Index const node : before_.nodes)
      if (Index const now = transfer_.renumbered(node); now >= 0)
        values[static_cast<std::size_t>(now)] = before[static_cast<std::size_t>(node)];
    transfer_.fill_new_nodes(values);
    return values;
  }

  /// A field in the rows of the layout after the change, with other values at the nodes that the change looks at.
  Array onto(typename Parts::layout_type const& next, Array const& field,
             Values const& values) const {
    std::vector<Index> places;
    places.reserve(after_.nodes.size());
    for (Index const node : after_.nodes) places.push_back(next.internal_of(node));
    return carried_field<dim>(parts_.backend, next.rows, field, next.freed_rows, places,
                              [&](std::size_t i, std::size_t k) { return values.values[i][k]; });
  }

 private:
  std::size_t old_node_count() const { return static_cast<std::size_t>(transfer_.old_nodes()); }
  /// −1 for a new node.
  Index old_number(Index now) const {
    return now < transfer_.staying_nodes() ? old_numbers_[now] : -1;
  }
  /// Those of elements that come or go, of hanging nodes and what they hang at, and parents of new nodes.
  std::vector<Index> nodes_before(Topology<M> const& before, Topology<M> const& after,
                                  TouchedElements<M> const& touched) const {
    std::vector<Index> list;
    auto const add_now = [&](Index now) {
      if (Index const old = old_number(now); old >= 0) list.push_back(old);
    };
    std::ranges::for_each(touched.nodes(), add_now);
    for (NewNode const& n : transfer_.gone()) list.push_back(n.node);
    auto const add_slaves = [](Interpolation const& interpolation, auto const& add) {
      for (auto const& [node, masters] : interpolation.slaves()) {
        add(node);
        for (auto const& [master, weight] : masters) add(master);
      }
    };
    add_slaves(before.interpolation, [&](Index old) { list.push_back(old); });
    add_slaves(after.interpolation, add_now);
    for (NewNode const& n : transfer_.new_nodes())
      for (auto const& [parent, weight] : n.parents) add_now(parent);
    return list;
  }
  std::vector<Index> nodes_after() const {
    std::vector<Index> list;
    for (Index const node : before_.nodes)
      if (Index const now = transfer_.renumbered(node); now >= 0) list.push_back(now);
    for (NewNode const& n : transfer_.new_nodes()) list.push_back(n.node);
    return list;
  }

  Parts const& parts_;
  Transfer<dim> const& transfer_;
  NumberMap old_numbers_;
  NodeSubset before_, after_;
  typename Parts::template Array<Index> places_before_;
};

}  // namespace pliant::detail
