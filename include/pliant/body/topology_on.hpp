#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include <pliant/backend/host_values.hpp>
#include <pliant/backend/read_back.hpp>
#include <pliant/body/acting_on.hpp>
#include <pliant/body/converted_elements_on.hpp>
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

/// How elements go over to another type.
enum class Conversion : std::size_t { degree, split, merge };

/// What a body keeps of its topology in a backend's memory while its mesh is changed there.
template <class M, Backend B>
struct TopologyOn;

template <Element... Es, Backend B>
struct TopologyOn<Mesh<Es...>, B> {
  using M = Mesh<Es...>;
  static constexpr int dim = M::dim;
  static constexpr std::size_t types = sizeof...(Es);
  static constexpr bool has_several = types > 1;
  /// Whether refined cells may have children of several types.
  static constexpr bool has_pyramids = detail::has_type<Pyramid5, M>;
  /// The type that elements of each become by a conversion; the same where there is none.
  static constexpr std::array<std::size_t, types> types_by(Conversion how) {
    auto const or_own = [](std::size_t found, std::size_t own) {
      return found == no_type ? own : found;
    };
    return {or_own(how == Conversion::degree  ? converted_type<Es, M>
                   : how == Conversion::split ? detail::type_in<SplitInto<Es>, M>
                                              : detail::whole_type<Es, M>,
                   detail::type_in<Es, M>)...};
  }
  /// After so many changes the host follows, or of so many cells for each element, so that what it has to keep has an end.
  static constexpr int most_changes = 512, most_cells = 64;
  /// Where the elements of each type begin among all, and behind the last one.
  using Bounds = std::array<Index, types + 1>;

  TreeOn<B> tree;
  LeafOrderOn<B> order;  // of all types, one behind the other
  Bounds first_block, first_place,
      first_before;  // in that: of blocks; of leaves, and of those before the last change
  std::vector<Index> first_of_blocks{};  // of all types, behind a change
  std::vector<Index> staying{};          // see LeafOrderOn; empty: nothing was converted
  NodeRowsOn<B> rows;
  std::array<ElementNumbersOn<B>, types> numbers;
  HangingNodesOn<dim, B> hanging;
  NodalMassesOn<B> masses;
  FamilyMomentumOn<dim, B> momentum;
  GoneNodesOn<B> gone;
  typename B::template Array<double> points;      // (rows, node_stride), m
  typename B::template Array<double> energies{};  // of a change
  typename B::template Array<Index>
      first_places{};  // of the initial mesh's cells, once some leaf went over to another type
  std::array<typename B::template Array<Index>, 3> other_blocks{};  // see LeafOrderOn::convert
  HeldSidesOn<dim, std::min({nodes_on_cell<Es>...}), std::max({nodes_on_cell<Es>...}), B> held;
  ActingOn<dim, B> acting;
  WhenAsked<Prescribed<dim>> prescribed{};  // that these are of
  HostValues<B, Index> from_host{};         // marked elements
  ReadBack<B, Index> unknown;               // (1): not 0 where a marked one is none
  OnHost<M> on_host;

  /// Of a body as it is. Takes a look at all of it.
  template <class Parts>
  explicit TopologyOn(Parts const& parts)
      : TopologyOn(parts, detail::tree_of(parts.state.topology.shared())) {}

  /// The leaves of type I.
  [[nodiscard]] LeavesView leaves(std::size_t type) const {
    return order.view(first_place[type], first_place[type + 1] - first_place[type],
                      first_before[type], first_before[type + 1] - first_before[type], has_several);
  }
  [[nodiscard]] ElementNumbersView element_numbers(std::size_t type) const {
    return numbers[type].of(leaves(type));
  }
  /// The first element of each block of a type, and behind the last one, counted from that type's first.
  [[nodiscard]] std::vector<Index> first_of_block(std::size_t type) const {
    std::vector<Index> own(first_of_blocks.begin() + first_block[type],
                           first_of_blocks.begin() + first_block[type + 1] + 1);
    for (Index& place : own) place -= first_place[type];
    return own;
  }
  /// How many leaves of a type before each of its blocks stayed, where some were converted.
  [[nodiscard]] std::vector<Index> staying_in(std::size_t type) const {
    if (staying.empty()) return {};
    return {staying.begin() + first_block[type], staying.begin() + first_block[type + 1] + 1};
  }
  /// Notes where types and blocks begin behind a change of the order, since which the backend was waited for.
  void follow_order(bool converts = false) {
    first_of_blocks = order.told_first_of_block();
    staying = converts ? order.told_staying() : std::vector<Index>{};
    first_before = first_place;
    for (std::size_t type = 0; type <= types; ++type)
      first_place[type] = first_of_blocks[static_cast<std::size_t>(first_block[type])];
  }
  /// Puts leaves that went over to another type among those of it: `what`, see LeafOrderOn::convert. `first`: of the initial mesh.
  template <class... What>
  void convert_order(B const& backend, Conversion how, CellOrder const& first,
                     What const&... what) {
    if (first_places.size() == 0) first_places = upload(backend, first.places);
    auto& other_block = other_blocks[static_cast<std::size_t>(how)];
    if (other_block.size() == 0) {
      auto const other_types = types_by(how);
      std::vector<Index> other;
      for (std::size_t type = 0; type < types; ++type)
        for (Index block = first_block[type]; block < first_block[type + 1]; ++block)
          other.push_back(block - first_block[type] + first_block[other_types[type]]);
      other_block = upload(backend, other);
    }
    order.convert(tree, what..., other_block.data(), first_places.data());
  }
  /// Puts children in the place of refined leaves, or parents in that of merged ones: a TreeOn::Refined, or Coarsened. `first`: of the initial
  /// mesh.
  template <class Done>
  void follow_order_of(B const& backend, CellOrder const& first, Done const& done) {
    if constexpr (has_pyramids) {
      if (first_places.size() == 0) first_places = upload(backend, first.places);
      if constexpr (std::same_as<Done, Coarsened>)
        order.convert(tree, done, first_places.data());
      else
        order.convert(
            tree, done,
            first_block[detail::type_in<Tet4, M>] - first_block[detail::type_in<Pyramid5, M>],
            first_places.data());
    } else if constexpr (std::same_as<Done, Coarsened>) {
      order.coarsen(tree, done);
    } else {
      order.refine(tree, done);
    }
  }
  /// Elements of one type that were of another one before such a change.
  [[nodiscard]] detail::ConvertedPlaces converted_places(std::size_t from, std::size_t to) const {
    auto const before = leaves(from);
    return {order.converted_families(), order.converted_count(), leaves(to), before.first_before,
            before.count_before};
  }
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
  void set_on_host(MeshOnHost<M> now) {
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
  TopologyOn(Parts const& parts, detail::RefinementTree<M> const& first)
      : tree(parts.backend, first.tree->tree().lists(), *first.tree->tree().cells_at_edges()),
        order(parts.backend, leaves_of(parts, *first.cells), blocks_of(parts), tree.sizes().cells),
        first_block(bounds([&](std::size_t type) {
          return static_cast<Index>(parts.layout.first_of_block[type].size()) - 1;
        })),
        first_place(
            bounds([&](std::size_t type) { return parts.layout.first_of_block[type].back(); })),
        first_before(first_place),
        rows(parts.backend, parts.layout.node_rows()),
        numbers{
            ElementNumbersOn<B>(parts.backend, tree, detail::cells_of_type<Es>(has_several))...},
        hanging(parts.backend, !(LinearSimplex<Es> && ...)),
        masses(parts.backend, by_row(parts), parts.layout.mass_unit, parts.material.density),
        momentum(parts.backend),
        gone(parts.backend),
        unknown(parts.backend, 1),
        on_host{.known = {parts.state.topology.shared(), parts.state.prescribed.shared()},
                .tree = first.tree} {
    std::vector<double> values(node_stride * static_cast<std::size_t>(rows.count()));
    for (Index node = 0; node < parts.layout.nodes(); ++node)
      for (std::size_t k = 0; k < dim; ++k)
        values[node_stride * static_cast<std::size_t>(parts.layout.internal_of(node)) + k] =
            parts.state.topology->point(node)[k];
    points = upload(parts.backend, values);
  }

  /// Sums of the counts of types.
  static Bounds bounds(auto const& count_of) {
    Bounds sums{};
    for (std::size_t type = 0; type < types; ++type) sums[type + 1] = sums[type] + count_of(type);
    return sums;
  }
  /// The cells of the elements, in the order of the layout, type after type.
  template <class Parts>
  static std::vector<Index> leaves_of(Parts const& parts, std::vector<CellSet> const& cells) {
    std::vector<Index> leaves;
    auto const add = [&](auto const& table, CellSet const& own) {
      std::vector<Index> const by_number(own.begin(), own.end());
      for (Index const number : table.user_elements())
        leaves.push_back(by_number[static_cast<std::size_t>(number)]);
    };
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (add(std::get<I>(parts.layout.tables), cells[I]), ...);
    }(std::index_sequence_for<Es...>());
    return leaves;
  }
  /// The first leaf of each block, type after type, and behind the last one.
  template <class Parts>
  static std::vector<Index> blocks_of(Parts const& parts) {
    std::vector<Index> first{0};
    for (auto const& of_type : parts.layout.first_of_block) {
      Index const before = first.back();
      for (std::size_t block = 1; block < of_type.size(); ++block)
        first.push_back(before + of_type[block]);
    }
    return first;
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
