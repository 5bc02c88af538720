#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <pliant/backend/elements_of_rows.hpp>
#include <pliant/body/change_topology.hpp>
#include <pliant/body/element_rows_on.hpp>
#include <pliant/body/fill_new_nodes_on.hpp>
#include <pliant/body/refine_passes.hpp>
#include <pliant/body/topology_on.hpp>
#include <pliant/topology/plan.hpp>
#include <pliant/topology/refined_elements.hpp>

// Refinement of bodies in their backend's memory: what the host knows of the mesh follows when it is asked for.
namespace pliant {

namespace detail {

/// Whether meshes of a backend are changed in its memory: where it says so by `keeps_trees`.
template <class B>
inline constexpr bool keeps_trees = false;
template <class B>
  requires requires { requires B::keeps_trees; }
inline constexpr bool keeps_trees<B> = true;

template <class M>
inline constexpr bool is_of_one_refinable_type = false;
template <Element E>
inline constexpr bool is_of_one_refinable_type<Mesh<E>> =
    E::degree == 1 && (LinearSimplex<E> || TensorCell<typename E::cell>);

/// Whether bodies of a kind may be refined in their backend's memory.
template <class Parts>
inline constexpr bool refines_on_backend = [] {
  if constexpr (keeps_trees<typename Parts::backend_type> &&
                is_of_one_refinable_type<typename Parts::mesh_type>) {
    using Laws = typename std::tuple_element_t<0, decltype(Parts::layout_type::tables)>::Laws;
    return !Parts::has_internal_variables && Laws::value_count == 0;
  } else {
    return false;
  }
}();

/// Whether nothing of a body has to look at lists of the host when its mesh is refined, and the host has not changed it: what it
/// does then takes less time than to bring the mesh over again.
template <class Parts>
bool can_refine_on_backend(Parts const& parts) {
  if (parts.mesh_is_on_host || !parts.listeners.empty() || !parts.term_makers.empty() ||
      parts.sleep != nullptr || !parts.pressures.empty() || !parts.driven.empty())
    return false;
  return parts.first->interpolation.empty();
}

/// What the host knows of a mesh that was refined in a backend's memory.
template <class M>
struct RefinedOnHost {
  std::shared_ptr<Topology<M> const> topology;
  std::shared_ptr<Prescribed<M::dim> const> prescribed;
};
/// The topology of a body, with some of its cells refined, and conditions there, when they are asked for.
template <class Parts, class Cells>
auto refined_when_asked(Parts const& parts, std::shared_ptr<Cells> cells) {
  using M = typename Parts::mesh_type;
  using Refined = RefinedOnHost<M>;
  return WhenAsked<Refined>::by(
      [before = parts.state.topology, prescribed = parts.state.prescribed, cells = std::move(cells),
       values = element_values_of(parts)]() -> std::shared_ptr<Refined const> {
        MarkedElements marked{.refine = {download<Index>(*cells)}};
        if (before->tree)
          for (Index& number : marked.refine[0]) number = before->cells[0].rank(number);
        auto const plan = plan_change(before.shared(), marked, {}, {}, values);
        return std::make_shared<Refined>(Refined{
            plan->after,
            std::make_shared<Prescribed<M::dim> const>(carried(*prescribed, plan->transfer))});
      });
}

/// Values by the row, by the user's number of a node.
template <class U>
std::vector<U> by_user(NodeRows const& rows, std::vector<U> const& by_row) {
  std::vector<U> values(rows.of_node.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = by_row[static_cast<std::size_t>(rows.of_node[i])];
  return values;
}

/// A body's parts behind a refinement in its backend's memory. Linear elements keep their momentum: what their children
/// interpolate is what they did, and lumped masses are the integrals of shape functions.
template <class Parts>
class RefinedParts {
  using B = typename Parts::backend_type;
  using M = typename Parts::mesh_type;
  using T = typename Parts::T;
  using Layout = typename Parts::layout_type;
  using Table = std::tuple_element_t<0, decltype(Layout::tables)>;
  using E = typename Table::element;
  using On = TopologyOn<M, B>;
  static constexpr int dim = Parts::dim;
  template <class U>
  using Array = typename Parts::template Array<U>;

 public:
  RefinedParts(Parts& parts, On& on, typename TreeOn<B>::Refined const& refined)
      : parts_(parts), on_(on), refined_(refined), backend_(parts.backend) {}

  ChangedTopology<Parts> make() {
    synchronize_velocities(parts_);
    check_fields();
    on_.order.refine(on_.tree, refined_);
    on_.rows.refine(on_.tree, on_.order, refined_);
    rows_ = on_.rows.count();
    on_.points = extended(backend_, on_.points, values());
    auto u = with_new_nodes(parts_.state.u), v = with_new_nodes(parts_.state.v);
    fill_new_nodes<E>(backend_, on_.tree, refined_, on_.rows.of_node(), on_.point_field());
    auto const elements = refined_elements<E>(on_.tree, refined_, on_.rows.of_node(),
                                              NodeField<double const, dim>{on_.points.data()});
    auto layout = new_layout();
    MassWeightsOn<B> const weights(backend_, layout.interpolation, rows_);
    on_.masses.extend(rows_);
    on_.masses.take_gone(elements);
    on_.masses.add_come(elements);
    on_.masses.read(weights, kilograms_->data());
    on_.masses.round(kilograms_->data(), layout.mass.data());
    *own_masses_ = copy_of(on_.masses.own());
    double const energy_before = strain_energy(elements, false, layout, parts_.state.u);

    ChangedTopology<Parts> changed{
        parts_on(parts_, std::move(layout), topology_, prescribed_), {}, energy_before};
    auto& next = changed.parts;
    auto& state = next.state;
    state.record.totals = closed_totals(parts_);
    state.record.born = state.steps;
    state.u = std::move(u);
    state.v = std::move(v);
    next.layout.interpolation.apply(next.backend, next.u());
    next.layout.interpolation.apply(next.backend, next.v());
    if (parts_.state.load.size() > 0) {
      state.load = extended(backend_, parts_.state.load, values());
      make_loads(next);
    }
    std::get<0>(state.elements).statistics = {};
    std::get<0>(next.layout.tables).elements.regroup();
    make_room_for_forces(next);
    state.integrator.next_check = state.integrator.next_refresh = state.steps;
    state.implicit = {};
    changed.strain_energy = strain_energy(elements, true, next.layout, state.u);
    return changed;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] std::size_t values() const { return node_stride * at(rows_); }

  /// Throws Error where a field is not finite.
  void check_fields() {
    Index const rows = parts_.layout.rows;
    auto const check_one = [&](char const* what, Array<T> const& field) {
      double const most = backend_.maximum(rows, RowSize<T, dim>{node_field<dim>(field)});
      if (!is_finite(most))
        check_field(what, parts_.layout.in_user_order(field), parts_.layout.nodes());
    };
    check_one("change of the mesh (displacements)", parts_.state.u);
    check_one("change of the mesh (velocities)", parts_.state.v);
  }
  Array<T> with_new_nodes(Array<T> const& field) {
    auto longer = extended(backend_, field, values());
    fill_new_nodes<E>(backend_, on_.tree, refined_, on_.rows.of_node(), node_field<dim>(longer));
    return longer;
  }
  template <class U>
  Array<U> copy_of(U const* from) {
    auto copy = zeros<U>(backend_, at(rows_));
    copy_values<B, U>(backend_, from, copy.data(), at(rows_));
    return copy;
  }

  /// With all but masses, which are left zero.
  Layout new_layout() {
    auto cells = std::make_shared<Array<Index>>(zeros<Index>(backend_, at(refined_.leaves)));
    backend_.for_each(refined_.leaves, CellOfSplit{refined_.cells, cells->data()});
    auto const refined = refined_when_asked(parts_, std::move(cells));
    topology_ = WhenAsked<Topology<M>>::by([refined] { return refined->topology; });
    prescribed_ = WhenAsked<Prescribed<dim>>::by([refined] { return refined->prescribed; });

    auto snapshot = std::make_shared<typename NodeRowsOn<B>::Lists>(on_.rows.lists());
    WhenAsked<NodeRows> const node_rows = WhenAsked<NodeRows>::by(
        [snapshot] { return std::make_shared<NodeRows>(snapshot->download_all()); });
    own_masses_ = std::make_shared<Array<ExactSum>>();
    kilograms_ = std::make_shared<Array<double>>(zeros<double>(backend_, at(rows_)));
    auto const listed = [node_rows]<class U>(std::shared_ptr<Array<U>> by_row) {
      return WhenAsked<SharedList<U>>::by([node_rows, by_row = std::move(by_row)] {
        return std::make_shared<SharedList<U>>(by_user(*node_rows, download<U>(*by_row)));
      });
    };
    auto const& before = parts_.layout;
    Layout layout(before, rows_,
                  {on_.rows.nodes(), node_rows, listed(own_masses_), listed(kilograms_),
                   copy_of(on_.rows.node())});
    auto blocks = blocks_after_refinement(on_.order, before.first_of_block[0]);
    make_table(std::get<0>(layout.tables), blocks);
    layout.first_of_block[0] = std::move(blocks.first);
    layout.rest = extended(backend_, before.rest, values());
    backend_.for_each(refined_.new_nodes, PlaceAtRest<T, dim>{refined_.nodes,
                                                              on_.rows.of_node(),
                                                              {on_.points.data()},
                                                              before.middle,
                                                              node_field<dim>(layout.rest)});
    auto const scratch = std::get<0>(layout.tables).elements.scratch_nodes();
    layout.f = zeros<T>(backend_, values() + node_stride * at(scratch));
    layout.held = extended(backend_, before.held, at(rows_));
    on_.held.refine(backend_, on_.tree, refined_, on_.rows.of_node(), layout.held.data());
    on_.prescribed = prescribed_;
    layout.mass = zeros<T>(backend_, at(rows_));
    layout.interpolation =
        InterpolationOn<B>(backend_, on_.hanging.rows(on_.tree, on_.rows.of_node()));
    return layout;
  }
  void make_table(Table& table, ElementBlocks const& blocks) {
    using Elements = typename B::template Elements<E::nodes>;
    constexpr int width = row_width<Elements>;
    auto const& before = std::get<0>(parts_.layout.tables);
    auto rows = element_rows<E, width>(backend_, on_.tree.view(), on_.order, on_.rows.of_node(),
                                       before.elements.rows_of_nodes());
    Array<Tag> tags;
    if constexpr (Table::groups > 1)
      tags = inherited_values<Tag>(backend_, on_.order,
                                   std::get<0>(parts_.state.elements).tags.data());
    table.elements =
        elements_of_rows<Elements>(backend_, std::move(rows), Table::groups, std::move(tags), rows_,
                                   node_order<E>, blocks, &before.elements);
    table.laws = before.laws;
    table.straight = before.straight;
    table.numbers = WhenAsked<ElementNumbers>::by(
        [topology = topology_, order = parts_.layout.first_order, first = blocks.first] {
          auto ordered = elements_in_order(*topology, *order);
          return std::make_shared<ElementNumbers>(std::move(ordered.cells[0]), first,
                                                  topology->cells[0]);
        });
  }

  /// Of refined elements, or of their children, J.
  double strain_energy(RefinedElements<E> const& elements, bool children, Layout const& layout,
                       Array<T> const& u) {
    constexpr int width = row_width<ElementListOn<B, E::nodes>>;
    Index const count = elements.count * (children ? RefinedElements<E>::most_children : 1);
    auto rows = zeros<Index>(backend_, at(count) * width);
    Array<Tag> tags;
    TakeFamilies<E, width> take{elements,         children,    nullptr, on_.order.places(),
                                on_.order.from(), rows.data(), nullptr};
    if constexpr (Table::groups > 1) {
      tags = zeros<Tag>(backend_, at(count));
      take.tags_before = std::get<0>(parts_.state.elements).tags.data();
      take.tags = tags.data();
    }
    backend_.for_each(count, take);
    auto const list =
        element_list<E::nodes>(backend_, std::move(rows), Table::groups, std::move(tags), rows_);
    auto const& table = std::get<0>(layout.tables);
    double sum = 0;
    table.with_geometry([&](auto geometry) {
      sum = backend_.template sum_elements<Table::groups>(
          list, EnergyKernel<typename Table::Laws, geometry.value>{table.laws},
          node_field<dim>(layout.rest), node_field<dim>(u));
    });
    return sum;
  }

  Parts& parts_;
  On& on_;
  typename TreeOn<B>::Refined refined_;
  B const& backend_;
  Index rows_ = 0;
  WhenAsked<Topology<M>> topology_;
  WhenAsked<Prescribed<dim>> prescribed_;
  std::shared_ptr<Array<ExactSum>> own_masses_;
  std::shared_ptr<Array<double>> kilograms_;
};

}  // namespace detail

}  // namespace pliant
