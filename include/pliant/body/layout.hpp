#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include <pliant/backend/carry_rows.hpp>
#include <pliant/backend/element_blocks.hpp>
#include <pliant/body/cell_order.hpp>
#include <pliant/body/element_table.hpp>
#include <pliant/body/layout_change.hpp>
#include <pliant/body/lumped_masses.hpp>
#include <pliant/body/motion.hpp>
#include <pliant/body/numbering.hpp>
#include <pliant/body/state.hpp>
#include <pliant/body/straight.hpp>
#include <pliant/body/touched_elements.hpp>
#include <pliant/constraint/interpolation_on.hpp>

namespace pliant {

/// What follows from a body's topology: numbering, and arrays in the backend's memory in internal order
/// that a run does not change, with room for forces. Another topology has another layout.
template <Backend B, class M, class... Fs>
struct Layout;

template <Backend B, Element... Es, class... Fs>
struct Layout<B, Mesh<Es...>, Fs...> {
  static constexpr int dim = Mesh<Es...>::dim;
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;
  template <class E>
  using Table =
      ElementTable<B, E, typename detail::FormulationsOf<E, detail::TypeList<>, Fs...>::type>;
  static_assert(((Table<Es>::groups > 0) && ...),
                "every element type of the mesh needs a Group of a formulation on that element");
  template <class E>
  static constexpr bool has = (std::same_as<E, Es> || ...);
  /// The place of an element type among the mesh's.
  template <class E>
  static constexpr std::size_t type_of = [] {
    std::size_t at = 0, found = 0;
    ((std::same_as<E, Es> ? found = at++ : at++), ...);
    return found;
  }();
  template <class F>
  static constexpr bool acts = has<typename F::element>;
  static_assert((acts<Fs> && ...), "every Group is of an element type that the mesh has");

  std::shared_ptr<CellOrder const> first_order;
  SharedList<double> own_masses;                // kg, in the user's order, slaves' with them
  SharedList<double> mass_list;                 // the same, slaves' handed on
  double mass_in_all = 0;                       // kg, of the first mesh
  std::vector<Index> internal_node, user_node;  // by the user's and by the internal number
  Index nodes = 0;
  Point<dim> middle{};        // m, of the box around the first mesh: `rest` is relative to it
  Array<T> rest, f;           // (nodes, 4); f with scratch rows behind
  Array<T> mass;              // (nodes)
  Array<DirectionMask> held;  // (nodes)
  Array<T> load;  // (nodes, 4): loads with those of slaves handed on; empty where not needed
  std::tuple<Table<Es>...> tables;
  std::array<std::vector<Index>, sizeof...(Es)> first_of_block;  // elements, by the type
  FirstNodes<sizeof...(Es)> first_nodes;  // of the same blocks; empty for the first mesh
  InterpolationOn<B> interpolation;
  /// While fields go over from a layout before a change: what has become of its nodes, by the internal number there; −1:
  /// gone.
  Array<Index> node_now;

  /// `other`: a layout of the same body, of another topology; null: this is the first one.
  Layout(B const& backend, Topology<Mesh<Es...>> const& topology, Elastic const& material,
         std::tuple<Group<Fs>...> const& groups, Layout const* other = nullptr) {
    if (other != nullptr) {
      first_order = other->first_order;
      middle = other->middle;
      mass_in_all = other->mass_in_all;
    }
    make(backend, topology, material, groups, nullptr,
         [&] { return SharedList(detail::lumped_masses(topology.mesh(), material.density)); });
  }
  /// The same from the layout before a change.
  Layout(B const& backend, Topology<Mesh<Es...>> const& topology, Elastic const& material,
         std::tuple<Group<Fs>...> const& groups, Layout const& before,
         Transfer<dim> const& transfer, detail::TouchedElements<Mesh<Es...>> const& touched,
         std::vector<Index> const& looked_at)
      : first_order(before.first_order), mass_in_all(before.mass_in_all), middle(before.middle) {
    Change const change{before, transfer, touched, looked_at};
    make(backend, topology, material, groups, &change, [&] {
      return detail::changed_masses(topology, material.density, before.own_masses, transfer,
                                    touched);
    });
  }

  OrderBefore<sizeof...(Es), dim> order(Transfer<dim> const& transfer,
                                        std::span<char const> changed) const {
    OrderBefore<sizeof...(Es), dim> kept{{}, transfer, changed};
    std::apply([&](auto const&... table) { kept.cells = {table.numbers.blocks()...}; }, tables);
    return kept;
  }
  /// The user's numbers of nodes, in the backend's memory.
  Array<Index> const& user_nodes_on(B const& backend) const {
    if (user_node_array_.size() == 0) user_node_array_ = upload(backend, user_node);
    return user_node_array_;
  }
  Index internal_of(Index user) const { return internal_node[static_cast<std::size_t>(user)]; }

  template <class E>
  Table<E>& table() {
    return std::get<Table<E>>(tables);
  }
  template <class E>
  Table<E> const& table() const {
    return std::get<Table<E>>(tables);
  }

  /// A field given per node in the user's order, padded and in internal order.
  std::vector<T> padded(std::vector<Point<dim>> const& values) const {
    return padded([&](std::size_t i, std::size_t k) { return values[i][k]; });
  }
  /// The inverse of `padded`.
  std::vector<Point<dim>> in_user_order(Array<T> const& array) const {
    auto const& field = on_host<T>(array);
    std::vector<Point<dim>> values(static_cast<std::size_t>(nodes));
    for (std::size_t i = 0; i < values.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k)
        values[i][k] = static_cast<double>(
            field[node_stride * static_cast<std::size_t>(internal_node[i]) + k]);
    return values;
  }

 private:
  static constexpr Index few_nodes = 16384;
  using Change = detail::LayoutChange<Layout, Mesh<Es...>>;

  /// The same of value(node, k).
  template <std::invocable<std::size_t, std::size_t> Value>
  std::vector<T> padded(Value const& value) const {
    std::vector<T> field(static_cast<std::size_t>(node_stride) * internal_node.size(), T(0));
    detail::for_each_on_host(nodes, few_nodes, [&](Index node) {
      auto const i = static_cast<std::size_t>(node);
      for (std::size_t k = 0; k < dim; ++k)
        field[node_stride * static_cast<std::size_t>(internal_node[i]) + k] =
            static_cast<T>(value(i, k));
    });
    return field;
  }

  /// find_own_masses() gives own_masses. `change`: null where there was none.
  template <class FindOwnMasses>
  void make(B const& backend, Topology<Mesh<Es...>> const& topology, Elastic const& material,
            std::tuple<Group<Fs>...> const& groups, Change const* change,
            FindOwnMasses const& find_own_masses) {
    HostThreads const threads(backend, topology);
    auto [numbering, ordered, changed] = detail::numbered(topology, first_order.get(), change);
    auto& blocks = ordered.blocks;
    first_nodes = std::move(numbering.first_nodes);
    if (!first_order) {
      first_order = std::make_shared<CellOrder const>(pliant::first_order(numbering));
      middle = detail::extent(topology).middle;
    }
    internal_node = numbering.internal_node;
    user_node = std::move(numbering.user_node);
    nodes = static_cast<Index>(user_node.size());

    if (change != nullptr) follow_nodes(backend, *change, blocks, changed);
    Index scratch = 0;
    [&, &numbering = numbering, &ordered = ordered]<std::size_t... I>(std::index_sequence<I...>) {
      (make_table<I>(backend, numbering, ordered, change, topology, material, groups, scratch),
       ...);
    }(std::index_sequence_for<Es...>());
    for (std::size_t type = 0; type < first_of_block.size(); ++type)
      first_of_block[type] = std::move(blocks[type].first);

    make_rest(backend, topology, change);
    f = zeros<T>(backend, rest.size() + static_cast<std::size_t>(node_stride) *
                                            static_cast<std::size_t>(scratch));
    held = zeros<DirectionMask>(backend, static_cast<std::size_t>(nodes));

    std::vector<Slave> internal = topology.interpolation.slaves();
    for (auto& slave : internal) {
      slave.node = internal_of(slave.node);
      for (auto& [master, weight] : slave.masters) master = internal_of(master);
    }
    interpolation = InterpolationOn<B>(backend, Interpolation(std::move(internal)));
    own_masses = find_own_masses();
    mass_list = own_masses;
    topology.interpolation.hand_masses(
        [&](Index i, int) -> double& { return mass_list.edit(static_cast<std::size_t>(i)); }, 1);
    if (mass_in_all == 0)
      for (double m : mass_list) mass_in_all += m;
    make_mass(backend, material.density, change);
  }

  /// Finds node_now, and tells blocks that stay where their elements were.
  void follow_nodes(B const& backend, Change const& change,
                    std::array<ElementBlocks, sizeof...(Es)>& blocks,
                    ChangedBlocks const& changed) {
    node_now = detail::nodes_now(backend, change, detail::KeptNodes(&change, changed), first_nodes,
                                 [&](Index user) { return internal_of(user); });
    for (std::size_t type = 0; type < blocks.size(); ++type) {
      if (!blocks[type].some_stay()) continue;
      blocks[type].first_before = change.before.first_of_block[type];
      blocks[type].node_now = std::as_const(node_now).data();
    }
  }

  template <std::size_t I>
  void make_table(B const& backend, Numbering<Es...>& numbering,
                  OrderedElements<sizeof...(Es)>& ordered, Change const* change,
                  Topology<Mesh<Es...>> const& topology, Elastic const& material,
                  std::tuple<Group<Fs>...> const& groups, Index& scratch) {
    auto& table = std::get<I>(tables);
    using TableType = std::remove_reference_t<decltype(table)>;
    constexpr bool by_blocks = PlansByBlocks<decltype(table.elements), B>;
    auto const& blocks = ordered.blocks[I];
    auto rows = std::move(std::get<I>(numbering.tables));
    if (ordered.cells[I].empty()) {
      table.numbers = ElementNumbers(std::move(numbering.user_element[I]));
    } else {
      rows = numbering.template rows_of<I>(topology, ordered.cells[I], blocks, !by_blocks);
      table.numbers = ElementNumbers(std::move(ordered.cells[I]), blocks.first, topology.cells[I]);
    }
    auto const make_elements = [&](auto const&... planned) {
      table.elements = {backend,
                        std::move(rows),
                        TableType::groups,
                        std::vector<Tag>(table.numbers.size(), 0),
                        nodes,
                        node_order<typename TableType::element>,
                        planned...};
    };
    if constexpr (by_blocks)
      make_elements(blocks,
                    change == nullptr ? nullptr : &std::get<I>(change->before.tables).elements);
    else
      make_elements();
    scratch = std::max(scratch, table.elements.scratch_nodes());
    table.straight = detail::is_straight<typename TableType::element, T>(topology);
    table.values = upload(backend, table.in_internal_order(topology.element_values[I]));
    [&]<int... G>(std::integer_sequence<int, G...>) {
      ((std::get<G>(table.laws.laws) =
            prepared<typename TableType::template formulation<G>>(law_cast<T>(
                std::get<Group<typename TableType::template formulation<G>>>(groups).law_for(
                    material)))),
       ...);
    }(std::make_integer_sequence<int, TableType::groups>());
  }

  /// Positions relative to the middle of the first mesh: single precision keeps its digits.
  void make_rest(B const& backend, Topology<Mesh<Es...>> const& topology, Change const* change) {
    auto const place = [&](std::size_t i, std::size_t k) {
      return topology.point(static_cast<Index>(i))[k] - middle[k];
    };
    if (change != nullptr) return carry_rest(backend, *change, place);
    auto const places = padded(place);
    detail::for_each_on_host(static_cast<Index>(places.size()), few_nodes, [&](Index i) {
      if (!std::isfinite(places[static_cast<std::size_t>(i)]))
        throw Error("body: the mesh reaches over ", 2 * detail::extent(topology).reach,
                    " m, which ", 8 * sizeof(T), " bits cannot hold; take other units");
    });
    rest = upload(backend, places);
  }

  /// The same where most nodes are where they were: others lie between those.
  template <class Place>
  void carry_rest(B const& backend, Change const& change, Place const& place) {
    auto const& made = change.transfer.new_nodes();
    std::vector<Index> places;
    for (NewNode const& n : made) places.push_back(internal_of(n.node));
    rest = detail::carried_field<dim>(backend, nodes, change.before.rest, node_now, places,
                                      [&](std::size_t i, std::size_t k) {
                                        return place(static_cast<std::size_t>(made[i].node), k);
                                      });
  }

  void make_mass(B const& backend, double density, Change const* change) {
    auto const checked = [&](Index user) {
      double const exact = mass_list[static_cast<std::size_t>(user)];
      T const m = static_cast<T>(exact);
      if (!(std::isfinite(m) && (m > T(0) || !(exact > 0)) &&
            std::isfinite(static_cast<T>(density))))
        throw Error("body: ", 8 * sizeof(T),
                    " bits cannot hold the mass of a node under the density ", density,
                    " kg/m³; take double, or other units");
      return m;
    };
    if (change != nullptr) {
      std::vector<Index> places;
      for (Index const node : change->looked_at) places.push_back(internal_of(node));
      mass = detail::carried_values(backend, nodes, change->before.mass, node_now, places,
                                    [&](std::size_t i) { return checked(change->looked_at[i]); });
      return;
    }
    std::vector<T> masses(mass_list.size());
    detail::for_each_on_host(nodes, few_nodes, [&](Index user) {
      masses[static_cast<std::size_t>(internal_of(user))] = checked(user);
    });
    mass = upload(backend, masses);
  }

  mutable Array<Index> user_node_array_;  // empty until it is asked for
};

}  // namespace pliant
