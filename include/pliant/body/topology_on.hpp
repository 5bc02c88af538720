#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <pliant/body/acting_on.hpp>
#include <pliant/body/element_numbers_on.hpp>
#include <pliant/body/family_momentum_on.hpp>
#include <pliant/body/gone_nodes_on.hpp>
#include <pliant/body/held_sides_on.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/body/nodal_masses_on.hpp>
#include <pliant/body/node_rows_on.hpp>
#include <pliant/body/when_asked.hpp>
#include <pliant/topology/hanging_nodes_on.hpp>
#include <pliant/topology/marked_elements.hpp>
#include <pliant/topology/tree_on.hpp>

namespace pliant {

/// What the host knows of a mesh.
template <class M>
struct MeshOnHost {
  std::shared_ptr<Topology<M> const> topology;
  std::shared_ptr<Prescribed<M::dim> const> prescribed;
};
/// How far the host is behind a mesh that is changed in a backend's memory.
template <class M>
struct OnHost {
  MeshOnHost<M> known;  // an earlier one, since which the tree notes changes
  std::shared_ptr<Hierarchy<M::dim> const> tree;  // of it
  int changes = 0;                                // since then
  std::size_t cells = 0;                          // that they divided or merged
  long version = 0;                               // of the mesh now
  bool is_changing = false;                       // between two versions
};

/// What a body keeps of its topology in a backend's memory while its mesh is changed there.
template <class M, Backend B>
struct TopologyOn;

/// Of a mesh with elements of one type.
template <Element E, Backend B>
struct TopologyOn<Mesh<E>, B> {
  using element = E;
  static constexpr int dim = E::dim;
  /// After so many changes the host follows, or of so many cells for each element, so that what it has to keep has an end.
  static constexpr int most_changes = 512, most_cells = 64;

  TreeOn<B> tree;
  LeafOrderOn<B> order;
  NodeRowsOn<B> rows;
  ElementNumbersOn<B> numbers;
  HangingNodesOn<dim, B> hanging;
  NodalMassesOn<E, B> masses;
  FamilyMomentumOn<E, B> momentum;
  GoneNodesOn<E, B> gone;
  typename B::template Array<double> points;  // (rows, node_stride), m
  HeldSidesOn<dim, B> held{nodes_on_cell<E>};
  ActingOn<dim, B> acting;
  WhenAsked<Prescribed<dim>> prescribed{};  // that these are of
  OnHost<Mesh<E>> on_host;

  /// Of a body as it is. Takes a look at all of it.
  template <class Parts>
  explicit TopologyOn(Parts const& parts)
      : TopologyOn(parts, detail::tree_of(parts.state.topology.shared())) {}

  [[nodiscard]] ElementNumbersView element_numbers() const { return numbers.of(order); }
  [[nodiscard]] NodeField<double, dim> point_field() { return node_field<dim>(points); }
  /// Whether what is prescribed is what a body's conditions and pressures are now.
  template <class Parts>
  [[nodiscard]] bool is_of_conditions(Parts const& parts) const {
    return prescribed.is(parts.state.prescribed);
  }
  /// Brings it up to them; whether that can be.
  template <class Parts>
  bool follow_conditions(Parts const& parts) {
    if (is_of_conditions(parts)) return true;
    auto const row_of = [&](Index node) { return parts.layout.internal_of(node); };
    if (!held.set(parts.backend, *detail::tree_of(parts.state.topology.shared()).tree,
                  *parts.state.prescribed, row_of, rows.count()))
      return false;
    acting.set(parts.backend, *parts.state.prescribed, row_of);
    prescribed = parts.state.prescribed;
    set_on_host({parts.state.topology.shared(), prescribed.shared()});
    return true;
  }

  /// Notes what the host knows of the mesh as it is now.
  void set_on_host(MeshOnHost<Mesh<E>> now) {
    on_host.tree = now.topology->tree_or_first();
    on_host.known = std::move(now);
    on_host.changes = 0;
    on_host.cells = 0;
    tree.begin_noting();
  }
  /// Whether the host has to follow before another change.
  [[nodiscard]] bool is_too_far_ahead() const {
    return on_host.changes >= most_changes ||
           on_host.cells >= most_cells * static_cast<std::size_t>(tree.leaves());
  }
  /// Whether it takes the host less time to bring the mesh over than to make all changes since what it knows, roughly: to make one
  /// is reckoned as long as to bring over a 64th of the elements, and to divide or merge an element as long as 32 of them.
  [[nodiscard]] bool is_far_ahead() const {
    auto const leaves = static_cast<std::size_t>(tree.leaves());
    return static_cast<std::size_t>(on_host.changes) * (leaves / 64) + 32 * on_host.cells > leaves;
  }

 private:
  template <class Parts>
  TopologyOn(Parts const& parts, detail::RefinementTree<Mesh<E>> const& first)
      : tree(parts.backend, first.tree->tree().lists(), *first.tree->tree().cells_at_edges()),
        order(parts.backend, leaves_of(parts, *first.cells), parts.layout.first_of_block[0],
              tree.sizes().cells),
        rows(parts.backend, parts.layout.node_rows()),
        numbers(parts.backend, tree),
        hanging(parts.backend, !LinearSimplex<E>),
        masses(parts.backend, by_row(parts), parts.layout.mass_unit, parts.material.density),
        momentum(parts.backend),
        gone(parts.backend),
        on_host{.known = {parts.state.topology.shared(), parts.state.prescribed.shared()},
                .tree = first.tree} {
    std::vector<double> values(node_stride * static_cast<std::size_t>(rows.count()));
    for (Index node = 0; node < parts.layout.nodes(); ++node)
      for (std::size_t k = 0; k < dim; ++k)
        values[node_stride * static_cast<std::size_t>(parts.layout.internal_of(node)) + k] =
            parts.state.topology->point(node)[k];
    points = upload(parts.backend, values);
  }

  /// The cells of the elements, in the order of the layout.
  template <class Parts>
  static std::vector<Index> leaves_of(Parts const& parts, std::vector<CellSet> const& cells) {
    std::vector<Index> const by_number(cells[0].begin(), cells[0].end());
    std::vector<Index> leaves;
    for (Index const number : std::get<0>(parts.layout.tables).user_elements())
      leaves.push_back(by_number[static_cast<std::size_t>(number)]);
    return leaves;
  }
  template <class Parts>
  static std::vector<detail::ExactSum> by_row(Parts const& parts) {
    std::vector<detail::ExactSum> sums(static_cast<std::size_t>(parts.layout.rows));
    for (Index node = 0; node < parts.layout.nodes(); ++node)
      sums[static_cast<std::size_t>(parts.layout.internal_of(node))] =
          parts.layout.own_masses()[static_cast<std::size_t>(node)];
    return sums;
  }
};

}  // namespace pliant
