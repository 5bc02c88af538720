#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <tuple>
#include <utility>

#include <pliant/backend/array_copies.hpp>
#include <pliant/backend/elements_of_rows.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/body/carried_points_on.hpp>
#include <pliant/body/change_on_backend.hpp>
#include <pliant/body/change_passes.hpp>
#include <pliant/body/element_rows_on.hpp>
#include <pliant/body/energy_sums_on.hpp>
#include <pliant/body/fill_new_nodes_on.hpp>
#include <pliant/body/finite_fields.hpp>
#include <pliant/body/gone_nodes_on.hpp>
#include <pliant/force/forces.hpp>
#include <pliant/topology/refined_elements.hpp>

namespace pliant::detail {

/// A body's parts behind a change of its mesh in the backend's memory. `On` has the tree after it, and follows.
template <class Parts>
class ChangedPartsOn {
  using B = typename Parts::backend_type;
  using M = typename Parts::mesh_type;
  using T = typename Parts::T;
  using Layout = typename Parts::layout_type;
  using Table = std::tuple_element_t<0, decltype(Layout::tables)>;
  using E = typename Table::element;
  using On = TopologyOn<M, B>;
  using Elements = typename B::template Elements<E::nodes>;
  using Copies = ArrayCopies<B>;
  using Energies = EnergySumsOn<Parts>;
  static constexpr int dim = Parts::dim;
  static constexpr Index few_hung = 2048;  // edges and sides on which nodes hang
  /// Whether elements that are refined have to be given momentum back. Linear ones keep theirs: what their children interpolate is
  /// what they did, and lumped masses are the integrals of shape functions.
  static constexpr bool moves_momentum = E::degree > 1;
  template <class U>
  using Array = typename Parts::template Array<U>;

 public:
  /// `on_host`: what the host knows of the mesh behind the change already; nothing: it makes the change, too, when it is asked.
  ChangedPartsOn(Parts& parts, std::shared_ptr<On> on, MeshOnHost<M> on_host)
      : parts_(parts),
        on_(std::move(on)),
        backend_(parts.backend),
        energies_(backend_),
        topology_(std::move(on_host.topology)),
        prescribed_(std::move(on_host.prescribed)) {}

  ChangedTopology<Parts> refined(typename TreeOn<B>::Refined const& done) {
    synchronize_velocities(parts_);
    energies_.add_kinetic(Energies::before, parts_);
    auto cells = std::make_shared<Array<Index>>(unset<Index>(backend_, at(done.leaves)));
    backend_.for_each(done.leaves, CellOfSplit{done.cells, cells->data()});
    follow_on_host(std::move(cells), false);
    on_->hanging.find_after(on_->tree, done);
    on_->order.refine(on_->tree, done);
    on_->rows.refine(on_->tree, on_->order, done);
    if (done.new_nodes == 0) backend_.synchronize();  // rows of new nodes were waited for
    rows_ = on_->rows.count();
    double const speed = moves_momentum ? largest_speed() : 0;
    Copies copies(backend_);
    auto points = copies.template extended<double>(on_->points, values());
    auto u = copies.template extended<T>(parts_.state.u, values());
    auto v = copies.template extended<T>(parts_.state.v, values());
    auto load = extended_load(copies);
    auto layout = new_layout(copies, [&](DirectionMask* held) {
      on_->held.refine(backend_, on_->tree, done, on_->rows.of_node(), rows_, held);
    });
    on_->points = std::move(points);
    on_->masses.extend(rows_);
    auto const come = refined_elements<E>(on_->tree, done, on_->rows.of_node(), at_rest());
    auto const filling =
        filling_new_nodes<E>(on_->tree, done, on_->rows.of_node(), on_->point_field(),
                             node_field<dim>(u), node_field<dim>(v));
    LoopStep const placing{done.new_nodes, PlaceAtRest<T, dim>{done.nodes,
                                                               on_->rows.of_node(),
                                                               {on_->points.data()},
                                                               layout.middle,
                                                               node_field<dim>(layout.rest)}};
    MassWeightsOn<B> const weights(backend_, layout.interpolation, rows_);
    if constexpr (moves_momentum) {
      in_turn(backend_, filling, placing);
      exchange_masses(come, weights, layout, speed, v);
    } else {
      on_->masses.exchange(come, filling, placing);
      read_masses(layout, weights);
    }
    RefinedPlaces<B> const places(backend_, on_->order, done);
    energies_.add_strain_at(Energies::before, parts_, places.go.data(), places.go_count);
    auto changed = parts_with(std::move(layout), std::move(u), std::move(v), std::move(load));
    changed.changed_rows = changed_rows<E>(parts_, come, rows_, false);
    energies_.add_strain_at(Energies::after, changed.parts, places.come.data(), places.come_count);
    read_energies(changed);
    if constexpr (moves_momentum) changed.taken = on_->momentum.taken();
    return changed;
  }

  ChangedTopology<Parts> coarsened(Coarsened const& done) {
    synchronize_velocities(parts_);
    energies_.add_kinetic(Energies::before, parts_);
    auto parents = std::make_shared<Array<Index>>(unset<Index>(backend_, at(done.merged)));
    copy_values<B, Index>(backend_, done.parents, parents->data(), at(done.merged));
    follow_on_host(std::move(parents), true);
    on_->hanging.find_after(on_->tree, done);
    on_->order.coarsen(on_->tree, done);
    on_->rows.coarsen(done);
    double const speed = largest_speed();
    rows_ = on_->rows.count();
    Copies copies(backend_);
    auto u = copies.template extended<T>(parts_.state.u, values());
    auto v = copies.template extended<T>(parts_.state.v, values());
    auto load = extended_load(copies);
    auto layout = new_layout(copies, [&](DirectionMask* held) {
      on_->held.hold(backend_, on_->tree, on_->rows.of_node(), rows_, held);
    });
    MergedElements<E> const families{on_->order.merged_families(), on_->order.merged_count(),
                                     std::get<0>(parts_.layout.tables).elements.rows_of_nodes(),
                                     std::get<0>(layout.tables).elements.rows_of_nodes(),
                                     ElementsByRows<E>(at_rest())};
    exchange_masses(families, MassWeightsOn<B>(backend_, layout.interpolation, rows_), layout,
                    speed, v);
    auto const clear = [&](Array<T>& field) {
      return LoopStep{on_->rows.freed_count(),
                      ClearListed<T, dim>{on_->rows.freed(), node_field<dim>(field)}};
    };
    in_turn(backend_, clear(u), clear(v), clear(layout.rest));
    if (load.size() > 0)
      InterpolationOn<B>(
          backend_, on_->gone.rows(families, on_->rows.freed(), on_->rows.freed_count(), rows_))
          .apply_transpose(backend_, node_field<dim>(load));
    auto changed = parts_with(std::move(layout), std::move(u), std::move(v), std::move(load));
    changed.changed_rows = changed_rows<E>(parts_, families, rows_, true);
    energies_.add_strain_of_merged(parts_, changed.parts, on_->order);
    read_energies(changed);
    changed.taken = on_->momentum.taken();
    return changed;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] std::size_t values() const { return node_stride * at(rows_); }
  NodeField<double const, dim> at_rest() const { return {on_->points.data()}; }

  void follow_on_host(std::shared_ptr<Array<Index>> cells, bool merged) {
    if (!topology_) {
      auto const changed = changed_when_asked(parts_, on_, std::move(cells), merged);
      topology_ = WhenAsked<Topology<M>>::by([changed] { return changed->topology; });
      prescribed_ = WhenAsked<Prescribed<dim>>::by([changed] { return changed->prescribed; });
    }
    on_->prescribed = prescribed_;
  }
  /// Of nodes; empty where there is none.
  Array<T> extended_load(Copies& copies) {
    if (parts_.state.load.size() == 0) return {};
    return copies.template extended<T>(parts_.state.load, values());
  }

  /// Behind a change, with all but masses, which are not set; what it takes of rows is that of before. Makes the copies. hold(a copy
  /// of what was held before): holds what is held now, before patches are planned, beside which loops over all take longer.
  template <class Hold>
  Layout new_layout(Copies& copies, Hold const& hold) {
    auto snapshot = std::make_shared<typename NodeRowsOn<B>::Lists>(on_->rows.lists(copies));
    WhenAsked<NodeRows> const node_rows = WhenAsked<NodeRows>::by(
        [snapshot] { return std::make_shared<NodeRows>(snapshot->download_all()); });
    own_masses_ = std::make_shared<Array<ExactSum>>();
    kilograms_ = std::make_shared<Array<double>>(unset<double>(backend_, at(rows_)));
    auto const listed = [node_rows]<class U>(std::shared_ptr<Array<U>> by_row) {
      return WhenAsked<SharedList<U>>::by([node_rows, by_row = std::move(by_row)] {
        return std::make_shared<SharedList<U>>(by_user(*node_rows, download<U>(*by_row)));
      });
    };
    auto const& before = parts_.layout;
    Layout layout(
        before, rows_,
        NodeLists<B>(on_->rows.nodes(), node_rows, listed(own_masses_), listed(kilograms_),
                     copies.copy_of(on_->rows.node(), at(rows_), at(rows_))));
    layout.rest = copies.template extended<T>(before.rest, values());
    layout.held = copies.template extended<DirectionMask>(before.held, at(rows_));
    copies.make();
    hold(layout.held.data());
    auto blocks = blocks_after_change(on_->order, before.first_of_block[0]);
    // The masters of a few are found while the host plans patches, which those of many would keep waiting.
    auto& hanging = on_->hanging;
    bool const are_few = hanging.count_found() <= few_hung;
    if (are_few) hanging.find_masters(on_->tree);
    make_table(std::get<0>(layout.tables), blocks);
    if (!are_few) hanging.find_masters(on_->tree);
    layout.first_of_block[0] = std::move(blocks.first);
    layout.mass = unset<T>(backend_, at(rows_));
    backend_.synchronize();
    layout.interpolation = hanging.interpolation(on_->tree, on_->rows.of_node(), rows_);
    return layout;
  }
  void make_table(Table& table, ElementBlocks const& blocks) {
    auto const& before = std::get<0>(parts_.layout.tables);
    auto rows =
        element_rows<E, row_width<Elements>>(backend_, on_->tree.view(), on_->order,
                                             on_->rows.of_node(), before.elements.rows_of_nodes());
    Array<Tag> tags;
    if constexpr (Table::groups > 1)
      tags = inherited_values<Tag>(backend_, on_->order,
                                   std::get<0>(parts_.state.elements).tags.data());
    table.elements =
        elements_of_rows<Elements>(backend_, std::move(rows), Table::groups, std::move(tags), rows_,
                                   node_order<E>, blocks, &before.elements);
    table.laws = before.laws;
    // Children have their parent's, so that those of a family are equal.
    if constexpr (Table::Laws::value_count > 0)
      table.values = inherited_values<T>(backend_, on_->order, before.values.data(),
                                         Index{Table::Laws::value_count});
    table.straight = before.straight;
    table.numbers = WhenAsked<ElementNumbers>::by(
        [topology = topology_, order = parts_.layout.first_order, first = blocks.first] {
          auto ordered = elements_in_order(*topology, *order);
          return std::make_shared<ElementNumbers>(std::move(ordered.cells[0]), first,
                                                  topology->cells[0]);
        });
  }
  /// m/s. Throws Error for velocities that are not finite.
  [[nodiscard]] double largest_speed() const {
    auto const& parts = std::as_const(parts_);
    double const speed = backend_.maximum(parts.layout.rows, RowSize<T, dim>{parts.v()});
    if (!is_finite(speed)) check_fields(parts);
    return speed;
  }
  /// Gives nodes the masses of elements that come for those of elements that go, and these the momentum of those. `speed`: the
  /// largest; `v`: of the layout.
  template <class Families>
  void exchange_masses(Families const& families, MassWeightsOn<B> const& weights, Layout& layout,
                       double speed, Array<T>& v) {
    MassWeightsOn<B> const weights_before(backend_, parts_.layout.interpolation, rows_);
    on_->masses.take_gone(families);
    on_->momentum.begin(families, weights_before, weights, on_->masses);
    on_->masses.add_come(families);
    read_masses(layout, weights);
    double const bound = 64 * parts_.layout.mass_in_all * std::max(speed, 1e-150);
    on_->momentum.give_back(families, weights_before, weights, parts_.material.density, bound,
                            kilograms_->data(), layout.held.data(), node_field<dim>(v));
  }
  void read_masses(Layout& layout, MassWeightsOn<B> const& weights) {
    *own_masses_ = unset<ExactSum>(backend_, at(rows_));
    on_->masses.read(weights, kilograms_->data(), own_masses_->data());
    on_->masses.round(kilograms_->data(), layout.mass.data());
  }
  ChangedTopology<Parts> parts_with(Layout layout, Array<T> u, Array<T> v, Array<T> load) {
    ChangedTopology<Parts> changed{parts_on(parts_, std::move(layout), topology_, prescribed_), {}};
    auto& next = changed.parts;
    next.state.u = std::move(u);
    next.state.v = std::move(v);
    next.state.load = std::move(load);
    carry_points(backend_, on_->tree.view(), on_->order, std::as_const(parts_), next);
    next.layout.interpolation.apply(next.backend, next.u(), next.v());
    finish(next);
    return changed;
  }
  void finish(Parts& next) {
    auto& state = next.state;
    state.record.totals = closed_totals(parts_);
    state.record.born = state.steps;
    if (state.load.size() > 0) make_loads(next);
    next.topology_on = on_;
    on_->acting.drive(next, *on_);
    if (next.upload_pressures) next.upload_pressures(next);
    renew_terms(next);
    std::get<0>(state.elements).statistics = {};
    std::get<0>(next.layout.tables).elements.regroup();
    make_room_for_forces(next);
    state.integrator.next_check = state.integrator.next_refresh = state.steps;
    state.implicit = {};
  }

  /// Waits for what was asked of the backend. Throws Error where a field was not finite, or a mass cannot be held.
  void read_energies(ChangedTopology<Parts>& changed) {
    energies_.add_kinetic(Energies::after, changed.parts);
    auto const sums = energies_.read();
    settle(backend_, std::get<0>(changed.parts.layout.tables).elements);
    if (!is_finite(sums.kinetic[Energies::before])) check_fields(std::as_const(parts_));
    on_->masses.template check<T>();
    changed.before = {sums.strain[Energies::before] + energy_of_added_terms(parts_),
                      sums.kinetic[Energies::before]};
    changed.after = {sums.strain[Energies::after] + energy_of_added_terms(changed.parts),
                     sums.kinetic[Energies::after]};
  }

  Parts& parts_;
  std::shared_ptr<On> on_;
  B const& backend_;
  Energies energies_;
  Index rows_ = 0;
  WhenAsked<Topology<M>> topology_;
  WhenAsked<Prescribed<dim>> prescribed_;
  std::shared_ptr<Array<ExactSum>> own_masses_;
  std::shared_ptr<Array<double>> kilograms_;
};

}  // namespace pliant::detail
