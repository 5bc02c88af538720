#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include <pliant/backend/carry_rows.hpp>
#include <pliant/body/cell_order.hpp>
#include <pliant/body/element_table.hpp>
#include <pliant/body/layout_change.hpp>
#include <pliant/body/lumped_masses.hpp>
#include <pliant/body/motion.hpp>
#include <pliant/body/node_lists.hpp>
#include <pliant/body/state.hpp>
#include <pliant/body/straight.hpp>
#include <pliant/constraint/interpolation_on.hpp>

namespace pliant {

/// What follows from a body's topology: numbering, and arrays in the backend's memory in internal order
/// that a run does not change, with room for forces. Another topology has another layout.
template <Backend B, class M, class... Fs>
struct Layout;

template <Backend B, Element... Es, class... Fs>
struct Layout<B, Mesh<Es...>, Fs...> : NodeLists<B> {
  using NodeLists<B>::nodes, NodeLists<B>::node_rows, NodeLists<B>::node_rows_when_asked,
      NodeLists<B>::mass_list, NodeLists<B>::internal_of;
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
  detail::SumUnit mass_unit;  // by the first mesh
  double mass_in_all = 0;     // kg, of the first mesh
  Index rows = 0;             // of fields of nodes: free ones are among them
  Point<dim> middle{};        // m, of the box around the first mesh: `rest` is relative to it
  Array<T> rest, f;           // (rows, 4); f with scratch rows behind
  Array<T> mass;              // (rows)
  Array<DirectionMask> held;  // (rows)
  Array<T> load;  // (rows, 4): loads with those of slaves handed on; empty where not needed
  std::tuple<Table<Es>...> tables;
  std::array<std::vector<Index>, sizeof...(Es)> first_of_block;  // elements, by the type
  InterpolationOn<B> interpolation;
  std::vector<Index> freed_rows;  // that were a node's before the last change

  /// `other`: a layout of the same body, of another topology; null: this is the first one. `known_rows`: of the nodes of a
  /// topology with a tree.
  Layout(B const& backend, Topology<Mesh<Es...>> const& topology, Elastic const& material,
         std::tuple<Group<Fs>...> const& groups, Layout const* other = nullptr,
         NodeRows known_rows = {}) {
    if (other != nullptr) keep_from(*other);
    make(backend, topology, material, groups, nullptr, std::move(known_rows));
  }
  /// The same from the layout before a change.
  Layout(B const& backend, Topology<Mesh<Es...>> const& topology, Elastic const& material,
         std::tuple<Group<Fs>...> const& groups, Layout const& before,
         Transfer<dim> const& transfer, detail::TouchedElements<Mesh<Es...>> const& touched,
         std::vector<Index> const& looked_at) {
    keep_from(before);
    Change const change{before, transfer, touched, looked_at};
    make(backend, topology, material, groups, &change, {});
  }

  /// The same body's, with nothing in it yet but these.
  Layout(Layout const& before, Index rows_of_nodes, NodeLists<B> lists)
      : NodeLists<B>(std::move(lists)), rows(rows_of_nodes) {
    keep_from(before);
  }

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
    std::vector<Point<dim>> values(static_cast<std::size_t>(nodes()));
    auto const& of_node = node_rows().of_node;
    for (std::size_t i = 0; i < values.size(); ++i)
      for (std::size_t k = 0; k < dim; ++k)
        values[i][k] =
            static_cast<double>(field[node_stride * static_cast<std::size_t>(of_node[i]) + k]);
    return values;
  }

 private:
  static constexpr Index few_nodes = 16384;
  using Change = detail::LayoutChange<Layout, Mesh<Es...>>;

  /// The same of value(node, k).
  template <std::invocable<std::size_t, std::size_t> Value>
  std::vector<T> padded(Value const& value) const {
    std::vector<T> field(static_cast<std::size_t>(node_stride) * static_cast<std::size_t>(rows),
                         T(0));
    auto const& of_node = node_rows().of_node;
    detail::for_each_on_host(nodes(), few_nodes, [&](Index node) {
      auto const i = static_cast<std::size_t>(node);
      for (std::size_t k = 0; k < dim; ++k)
        field[node_stride * static_cast<std::size_t>(of_node[i]) + k] = static_cast<T>(value(i, k));
    });
    return field;
  }

  /// What follows from the first mesh.
  void keep_from(Layout const& other) {
    first_order = other.first_order;
    middle = other.middle;
    mass_unit = other.mass_unit;
    mass_in_all = other.mass_in_all;
  }

  /// `change`: null where there was none. `known`: see the constructor.
  void make(B const& backend, Topology<Mesh<Es...>> const& topology, Elastic const& material,
            std::tuple<Group<Fs>...> const& groups, Change const* change, NodeRows known) {
    HostThreads const threads(backend, topology);
    OrderedElements<sizeof...(Es)> ordered;
    std::optional<Numbering<Es...>> numbering;  // of a first mesh
    if (!first_order || !topology.tree) {
      numbering.emplace(topology.mesh());
      ordered.blocks = first_blocks(topology.mesh());
      known = {numbering->internal_node, std::move(numbering->user_node), {}};
    } else if (change == nullptr) {
      ordered = elements_in_order(topology, *first_order);
    } else {
      std::tie(ordered, known, freed_rows) = detail::order_after(topology, *first_order, *change);
    }
    if (!first_order) {
      first_order = std::make_shared<CellOrder const>(pliant::first_order(*numbering));
      auto const box = detail::extent(topology);
      middle = box.middle;
      mass_unit = detail::unit_of_masses(material.density, box.volume);
    }
    rows = known.count();
    this->set_rows(std::move(known));

    Index scratch = 0;
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (make_table<I>(backend, numbering ? &*numbering : nullptr, ordered, change, topology,
                     material, groups, scratch),
       ...);
    }(std::index_sequence_for<Es...>());
    for (std::size_t type = 0; type < first_of_block.size(); ++type)
      first_of_block[type] = std::move(ordered.blocks[type].first);

    make_rest(backend, topology, change);
    f = zeros<T>(backend, rest.size() + static_cast<std::size_t>(node_stride) *
                                            static_cast<std::size_t>(scratch));
    held = zeros<DirectionMask>(backend, static_cast<std::size_t>(rows));

    interpolation = InterpolationOn<B>(backend, topology.interpolation,
                                       [this](Index node) { return internal_of(node); });
    find_masses(topology, material.density, change);
    make_mass(backend, material.density, change);
  }

  /// `numbering`: of a first mesh, or null.
  template <std::size_t I>
  void make_table(B const& backend, Numbering<Es...>* numbering,
                  OrderedElements<sizeof...(Es)>& ordered, Change const* change,
                  Topology<Mesh<Es...>> const& topology, Elastic const& material,
                  std::tuple<Group<Fs>...> const& groups, Index& scratch) {
    auto& table = std::get<I>(tables);
    using TableType = std::remove_reference_t<decltype(table)>;
    using E = typename TableType::element;
    constexpr bool by_blocks = PlansByBlocks<decltype(table.elements), B>;
    auto const& blocks = ordered.blocks[I];
    std::vector<Connectivity<E>> connectivity;
    if (numbering != nullptr) {
      connectivity = std::move(std::get<I>(numbering->tables));
      table.numbers = ElementNumbers(std::move(numbering->user_element[I]));
    } else {
      connectivity = rows_of_blocks<E>(topology, ordered.cells[I], blocks, !by_blocks, node_rows());
      table.numbers = ElementNumbers(std::move(ordered.cells[I]), blocks.first, topology.cells[I]);
    }
    auto const make_elements = [&](auto const&... planned) {
      table.elements = {backend,
                        std::move(connectivity),
                        TableType::groups,
                        std::vector<Tag>{},
                        rows,
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
    rest = detail::carried_field<dim>(backend, rows, change.before.rest, freed_rows, places,
                                      [&](std::size_t i, std::size_t k) {
                                        return place(static_cast<std::size_t>(made[i].node), k);
                                      });
  }

  void find_masses(Topology<Mesh<Es...>> const& topology, double density, Change const* change) {
    auto own = change == nullptr
                   ? SharedList(detail::lumped_masses(topology.mesh(), density, mass_unit))
                   : detail::changed_masses(*change, density);
    auto list = change == nullptr ? detail::in_kilograms(own, mass_unit)
                                  : detail::changed_in_kilograms(*change, own);
    topology.interpolation.hand_masses(
        [&](Index i, int) -> double& { return list.edit(static_cast<std::size_t>(i)); }, 1);
    if (mass_in_all == 0)
      for (double m : list) mass_in_all += m;
    this->set_masses(std::move(own), std::move(list));
  }

  void make_mass(B const& backend, double density, Change const* change) {
    auto const checked = [&](Index user) {
      return detail::checked_mass<T>(mass_list()[static_cast<std::size_t>(user)], density);
    };
    if (change != nullptr) {
      std::vector<Index> places;
      for (Index const node : change->looked_at) places.push_back(internal_of(node));
      mass = detail::carried_values(backend, rows, change->before.mass, freed_rows, places,
                                    [&](std::size_t i) { return checked(change->looked_at[i]); });
      return;
    }
    std::vector<T> masses(static_cast<std::size_t>(rows));
    detail::for_each_on_host(nodes(), few_nodes, [&](Index user) {
      masses[static_cast<std::size_t>(internal_of(user))] = checked(user);
    });
    mass = upload(backend, masses);
  }
};

}  // namespace pliant
