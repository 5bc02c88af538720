#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>

#include <pliant/backend/array_copies.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/body/carried_points_on.hpp>
#include <pliant/body/change_passes.hpp>
#include <pliant/body/changed_families_on.hpp>
#include <pliant/body/changed_layout_on.hpp>
#include <pliant/body/element_rows_on.hpp>
#include <pliant/body/energy_sums_on.hpp>
#include <pliant/body/fill_new_nodes_on.hpp>
#include <pliant/body/finite_fields.hpp>
#include <pliant/body/gone_nodes_on.hpp>
#include <pliant/force/forces.hpp>

namespace pliant::detail {

/// A body's parts behind a change of its mesh in the backend's memory. `On` has the tree after it, and follows.
template <class Parts>
class ChangedPartsOn {
 protected:
  using B = typename Parts::backend_type;
  using M = typename Parts::mesh_type;
  using T = typename Parts::T;
  using Layout = typename Parts::layout_type;
  template <std::size_t I>
  using Table = std::tuple_element_t<I, decltype(Layout::tables)>;
  template <std::size_t I>
  using ElementOf = typename Table<I>::element;
  using On = TopologyOn<M, B>;
  using Copies = ArrayCopies<B>;
  using Energies = EnergySumsOn<Parts>;
  static constexpr int dim = Parts::dim;
  /// Whether elements that are refined have to be given momentum back. Linear ones but pyramids keep theirs: what their children
  /// interpolate is what they did, and lumped masses are the integrals of shape functions.
  static constexpr bool moves_momentum =
      On::has_pyramids || on_types<On::types>([]<std::size_t... I>(TypeNumber<I>...) {
        return ((ElementOf<I>::degree > 1) || ...);
      });
  template <class U>
  using Array = typename Parts::template Array<U>;

 public:
  /// `on_host`: what the host knows of the mesh behind the change already; nothing: it makes the change, too, when it is asked.
  ChangedPartsOn(Parts& parts, std::shared_ptr<On> on, MeshOnHost<M> on_host)
      : parts_(parts),
        on_(std::move(on)),
        backend_(parts.backend),
        layout_(parts, on_),
        energies_(backend_, on_->energies),
        topology_(std::move(on_host.topology)),
        prescribed_(std::move(on_host.prescribed)) {}

  ChangedTopology<Parts> refined(typename TreeOn<B>::Refined const& done) {
    synchronize_velocities(parts_);
    auto cells = std::make_shared<Array<Index>>(unset<Index>(backend_, at(done.leaves)));
    on_->hanging.find_after(on_->tree, done, energies_.clearing(),
                            LoopStep{done.leaves, CellOfSplit{done.cells, cells->data()}});
    follow_on_host(std::move(cells), ChangeOfCells::refine);
    on_->follow_order_of(backend_, *parts_.layout.first_order, done);
    on_->rows.extend(on_->tree, on_->order, done);
    if (done.new_nodes == 0) backend_.synchronize();  // rows of new nodes were waited for
    on_->follow_order(On::has_pyramids);
    layout_.converts = On::has_pyramids;
    rows_ = on_->rows.count();
    double const speed = moves_momentum ? largest_speed() : 0;
    Copies copies(backend_);
    auto points = copies.template extended<double>(on_->points, values());
    auto u = copies.template extended<T>(parts_.state.u, values());
    auto v = copies.template extended<T>(parts_.state.v, values());
    auto load = extended_load(copies);
    auto layout = layout_.make(copies, topology_, [&](DirectionMask* held) {
      on_->held.refine(backend_, on_->tree, done, on_->rows.of_node(), rows_, held);
    });
    energies_.add_kinetic(Energies::before, parts_);
    on_->points = std::move(points);
    on_->masses.extend(rows_);
    MassWeightsOn<B> const weights(backend_, layout.interpolation, rows_);
    LoopStep const placing{done.new_nodes, PlaceAtRest<T, dim>{done.nodes,
                                                               on_->rows.of_node(),
                                                               {on_->points.data()},
                                                               layout.middle,
                                                               node_field<dim>(layout.rest)}};
    return on_types<On::types>([&]<std::size_t... I>(TypeNumber<I>...) {
      auto const filling = [&]<Element E>(E) {
        return filling_new_nodes<E>(on_->tree, done, On::has_several, on_->rows.of_node(),
                                    on_->point_field(), node_field<dim>(u), node_field<dim>(v));
      };
      auto const exchange = [&](auto const&... come) {
        if constexpr (moves_momentum) {
          in_turn(backend_, filling(ElementOf<I>{})..., placing);
          exchange_masses(weights, layout, speed, v, come...);
        } else {
          in_turn(backend_, filling(ElementOf<I>{})..., placing, on_->masses.taking_gone(come)...,
                  on_->masses.adding_come(come)...);
          layout_.read_masses(layout, weights);
        }
      };
      exchange(refined<I>(done)...);
      std::array<RefinedPlaces<B>, On::types> const places{
          RefinedPlaces<B>(backend_, on_->leaves(I), done, come_in_all(done))...};
      (energies_.template add_strain_at<I>(Energies::before, parts_, places[I].go.data(),
                                           places[I].go_count),
       ...);
      auto changed = parts_with(std::move(layout), std::move(u), std::move(v), std::move(load));
      changed.changed_rows = changed_rows(parts_, rows_, false, refined<I>(done)...);
      (energies_.template add_strain_at<I>(Energies::after, changed.parts, places[I].come.data(),
                                           places[I].come_count),
       ...);
      read_energies(changed);
      if constexpr (moves_momentum) changed.taken = on_->momentum.taken();
      return changed;
    });
  }

  ChangedTopology<Parts> coarsened(Coarsened const& done) {
    synchronize_velocities(parts_);
    auto parents = std::make_shared<Array<Index>>(unset<Index>(backend_, at(done.merged)));
    on_->hanging.find_after(on_->tree, done, energies_.clearing(),
                            LoopStep{done.merged, CopyValue<Index>{done.parents, parents->data()}});
    follow_on_host(std::move(parents), ChangeOfCells::coarsen);
    on_->follow_order_of(backend_, *parts_.layout.first_order, done);
    on_->rows.coarsen(done);
    double const speed = largest_speed();  // waits
    on_->follow_order(On::has_pyramids);
    layout_.converts = On::has_pyramids;
    rows_ = on_->rows.count();
    Copies copies(backend_);
    auto u = copies.template extended<T>(parts_.state.u, values());
    auto v = copies.template extended<T>(parts_.state.v, values());
    auto load = extended_load(copies);
    auto layout = layout_.make(copies, topology_, [&](DirectionMask* held) {
      on_->held.hold(backend_, on_->tree, on_->rows.of_node(), rows_, held);
    });
    energies_.add_kinetic(Energies::before, parts_);
    MassWeightsOn<B> const weights(backend_, layout.interpolation, rows_);
    return on_types<On::types>([&]<std::size_t... I>(TypeNumber<I>...) {
      std::tuple const families{merged_families<I>(*on_, parts_.layout, layout)...};
      exchange_masses(weights, layout, speed, v, std::get<I>(families)...);
      clear_gone(layout, u, v, load, std::get<I>(families)...);
      auto changed = parts_with(std::move(layout), std::move(u), std::move(v), std::move(load));
      changed.changed_rows = changed_rows(parts_, rows_, true, std::get<I>(families)...);
      energies_.add_strain_of_merged(parts_, changed.parts, {on_->leaves(I)...});
      read_energies(changed);
      changed.taken = on_->momentum.taken();
      return changed;
    });
  }

 protected:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] std::size_t values() const { return node_stride * at(rows_); }
  NodeField<double const, dim> at_rest() const { return {on_->points.data()}; }

  template <std::size_t I>
  auto refined(typename TreeOn<B>::Refined const& done) const {
    return refined_families<ElementOf<I>>(*on_, done);
  }
  [[nodiscard]] Index come_in_all(typename TreeOn<B>::Refined const& done) const {
    return on_->order.count() - on_->order.count_before() + done.leaves;
  }
  void follow_on_host(std::shared_ptr<Array<Index>> cells, ChangeOfCells change) {
    if (!topology_) {
      auto const changed = changed_when_asked(parts_, on_, std::move(cells), change);
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

  /// m/s. Throws Error for velocities that are not finite.
  [[nodiscard]] double largest_speed() const {
    auto const& parts = std::as_const(parts_);
    double const speed = backend_.maximum(parts.layout.rows, RowSize<T, dim>{parts.v()});
    if (!is_finite(speed)) check_fields(parts);
    return speed;
  }
  /// Gives nodes the masses of elements that come for those of elements that go, and these the momentum of those. `speed`: the
  /// largest; `v`: of the layout.
  template <class... Families>
  void exchange_masses(MassWeightsOn<B> const& weights, Layout& layout, double speed, Array<T>& v,
                       Families const&... families) {
    MassWeightsOn<B> const weights_before(backend_, parts_.layout.interpolation, rows_);
    (visit_tets(families, [&](auto const& tets) { on_->masses.take_gone(tets); }), ...);
    on_->momentum.begin(weights_before, weights, on_->masses, families...);
    (visit_tets(families, [&](auto const& tets) { on_->masses.add_come(tets); }), ...);
    layout_.read_masses(layout, weights);
    double const bound = 64 * parts_.layout.mass_in_all * std::max(speed, 1e-150);
    on_->momentum.give_back(weights_before, weights, parts_.material.density, bound,
                            layout_.kilograms(), layout.held.data(), node_field<dim>(v),
                            families...);
  }
  /// Takes nodes that went what they had; their loads go to those that they lay between.
  template <class... Families>
  void clear_gone(Layout& layout, Array<T>& u, Array<T>& v, Array<T>& load,
                  Families const&... families) {
    auto const clear = [&](Array<T>& field) {
      return LoopStep{on_->rows.freed_count(),
                      ClearListed<T, dim>{on_->rows.freed(), node_field<dim>(field)}};
    };
    in_turn(backend_, clear(u), clear(v), clear(layout.rest));
    if (load.size() == 0) return;
    InterpolationOn<B>(
        backend_, on_->gone.rows(on_->rows.freed(), on_->rows.freed_count(), rows_, families...))
        .apply_transpose(backend_, node_field<dim>(load));
  }
  ChangedTopology<Parts> parts_with(Layout layout, Array<T> u, Array<T> v, Array<T> load) {
    ChangedTopology<Parts> changed{parts_on(parts_, std::move(layout), topology_, prescribed_), {}};
    auto& next = changed.parts;
    next.state.u = std::move(u);
    next.state.v = std::move(v);
    next.state.load = std::move(load);
    on_types<On::types>([&]<std::size_t... I>(TypeNumber<I>...) {
      (carry_points<I>(backend_, on_->tree.view(), on_->leaves(I), std::as_const(parts_), next),
       ...);
    });
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
    next.for_each_type([](auto& table, auto& elements) {
      elements.statistics = {};
      table.elements.regroup();
    });
    make_room_for_forces(next);
    state.integrator.next_check = state.integrator.next_refresh = state.steps;
    state.implicit = {};
  }

  /// Waits for what was asked of the backend. Throws Error where a field was not finite, or a mass cannot be held.
  void read_energies(ChangedTopology<Parts>& changed) {
    energies_.add_kinetic(Energies::after, changed.parts);
    auto const sums = energies_.read();
    changed.parts.for_each_type(
        [&](auto& table, auto const&) { settle(backend_, table.elements); });
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
  ChangedLayoutOn<Parts> layout_;
  Energies energies_;
  Index rows_ = 0;
  WhenAsked<Topology<M>> topology_;
  WhenAsked<Prescribed<dim>> prescribed_;
};

}  // namespace pliant::detail
