#pragma once

#include <cstddef>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>

#include <pliant/body/changed_parts_on.hpp>
#include <pliant/body/converted_elements_on.hpp>

namespace pliant::detail {

/// A body's parts behind a change of the degree of elements in the backend's memory. `On` has the tree after it, and follows.
template <class Parts>
class ConvertedPartsOn : ChangedPartsOn<Parts> {
  using Base = ChangedPartsOn<Parts>;
  using Base::at, Base::on_, Base::backend_, Base::parts_, Base::layout_, Base::energies_,
      Base::rows_, Base::topology_, Base::dim;
  using typename Base::B, typename Base::T, typename Base::Copies, typename Base::Energies,
      typename Base::On, typename Base::Layout;
  template <std::size_t I>
  using ElementOf = typename Base::template ElementOf<I>;
  template <class U>
  using Array = typename Parts::template Array<U>;

 public:
  using Base::Base;

  ChangedTopology<Parts> changed(Raised const& done) {
    return converted(
        done.cells, done.raised, ChangeOfCells::raise,
        [&] { on_->rows.extend(on_->tree, on_->order, done); },
        [&](Layout& layout, Array<T>& u, Array<T>& v) {
          LoopStep const placing{done.new_nodes, PlaceAtRest<T, dim>{done.nodes,
                                                                     on_->rows.of_node(),
                                                                     {on_->points.data()},
                                                                     layout.middle,
                                                                     node_field<dim>(layout.rest)}};
          on_types<On::types>([&]<std::size_t... I>(TypeNumber<I>...) {
            in_turn(backend_,
                    filling_new_nodes<ElementOf<I>>(on_->tree, done, On::has_several,
                                                    on_->rows.of_node(), on_->point_field(),
                                                    node_field<dim>(u), node_field<dim>(v))...,
                    placing);
          });
        },
        [](auto const&...) {});
  }
  ChangedTopology<Parts> changed(Lowered const& done) {
    return converted(
        done.lowered_cells, done.lowered, ChangeOfCells::lower, [&] { on_->rows.coarsen(done); },
        [](auto const&...) {}, [&](auto&... what) { this->clear_gone(what...); });
  }

 private:
  /// Pairs of types, of elements of which a change of degree makes those of the other.
  template <class Visit>
  static void for_each_pair(Visit const& visit) {
    on_types<On::types>([&]<std::size_t... I>(TypeNumber<I>...) {
      auto const from = [&]<std::size_t From>(TypeNumber<From> own) {
        auto const to = [&]<std::size_t To>(TypeNumber<To> other) {
          if constexpr (differ_in_degree<ElementOf<From>, ElementOf<To>>) visit(own, other);
        };
        (to(TypeNumber<I>{}), ...);
      };
      (from(TypeNumber<I>{}), ...);
    });
  }
  template <std::size_t From, std::size_t To>
  auto families(Index const* cells, Index count, Layout const& layout) const {
    using E = ElementOf<From>;
    using F = ElementOf<To>;
    return ConvertedElements<E, F>{cells,
                                   count,
                                   places_of_converted(on_->leaves(To), on_->leaves(From)),
                                   std::get<From>(parts_.layout.tables).elements.rows_of_nodes(),
                                   std::get<To>(layout.tables).elements.rows_of_nodes(),
                                   ElementsByRows<E>(this->at_rest()),
                                   ElementsByRows<F>(this->at_rest())};
  }
  /// f(families...), of all pairs.
  template <class F>
  auto with_families(Index const* cells, Index count, Layout const& layout, F const& f) const {
    return on_types<On::types * On::types>([&]<std::size_t... P>(TypeNumber<P>...) {
      auto const one = [&]<std::size_t Pair>(TypeNumber<Pair>) {
        constexpr std::size_t from = Pair / On::types, to = Pair % On::types;
        if constexpr (differ_in_degree<ElementOf<from>, ElementOf<to>>)
          return std::tuple(families<from, to>(cells, count, layout));
        else
          return std::tuple();
      };
      return std::apply(f, std::tuple_cat(one(TypeNumber<P>{})...));
    });
  }

  /// add_rows(): gives new nodes rows, or frees those of others; fill(layout, u, v): gives the former values; clear(layout, u, v,
  /// load, families...): see clear_gone.
  template <class AddRows, class Fill, class Clear>
  ChangedTopology<Parts> converted(Index const* cells, Index count, ChangeOfCells change,
                                   AddRows const& add_rows, Fill const& fill, Clear const& clear) {
    synchronize_velocities(parts_);
    energies_.add_kinetic(Energies::before, parts_);
    auto list = std::make_shared<Array<Index>>(unset<Index>(backend_, at(count)));
    copy_values<B, Index>(backend_, cells, list->data(), at(count));
    this->follow_on_host(std::move(list), change);
    on_->hanging.find(on_->tree);
    on_->convert_order(backend_, cells, count, *parts_.layout.first_order);
    add_rows();
    double const speed = this->largest_speed();  // waits
    on_->follow_order();
    rows_ = on_->rows.count();
    Copies copies(backend_);
    auto points = copies.template extended<double>(on_->points, this->values());
    auto u = copies.template extended<T>(parts_.state.u, this->values());
    auto v = copies.template extended<T>(parts_.state.v, this->values());
    auto load = this->extended_load(copies);
    layout_.converts = true;
    auto layout = layout_.make(copies, topology_, [&](DirectionMask* held) {
      on_->held.extend(backend_, rows_);
      on_->held.hold(backend_, on_->tree, on_->rows.of_node(), rows_, held);
    });
    on_->points = std::move(points);
    on_->masses.extend(rows_);
    fill(layout, u, v);
    MassWeightsOn<B> const weights(backend_, layout.interpolation, rows_);
    with_families(cells, count, layout, [&](auto const&... families) {
      this->exchange_masses(weights, layout, speed, v, families...);
      clear(layout, u, v, load, families...);
    });
    auto changed = this->parts_with(std::move(layout), std::move(u), std::move(v), std::move(load));
    for_each_pair([&]<std::size_t From, std::size_t To>(TypeNumber<From>, TypeNumber<To>) {
      convert_points<From, To>(changed.parts);
    });
    changed.changed_rows = with_families(
        cells, count, changed.parts.layout,
        [&](auto const&... families) { return changed_rows(parts_, rows_, true, families...); });
    on_types<On::types>([&]<std::size_t... I>(TypeNumber<I>...) {
      energies_.add_strain_of_merged(parts_, changed.parts, {on_->leaves(I)...});
    });
    this->read_energies(changed);
    changed.taken = on_->momentum.taken();
    return changed;
  }
  /// Gives elements of type To that were of type From what their points kept.
  template <std::size_t From, std::size_t To>
  void convert_points(Parts& next) {
    using Source = typename Base::template Table<From>;
    using Target = typename Base::template Table<To>;
    if constexpr (Source::Laws::internal_variable_count > 0 &&
                  Target::Laws::internal_variable_count > 0) {
      constexpr std::size_t groups{Source::groups};
      static auto const sources = converted_sources<Source, Target>();
      auto const list = upload(backend_, sources.points);
      auto const leaves = on_->leaves(To), other = on_->leaves(From);
      auto const& before = std::get<From>(parts_.state.elements);
      auto& now = std::get<To>(next.state.elements);
      backend_.for_each(
          leaves.count,
          ConvertPoints<T, groups>{places_of_converted(leaves, other),
                                   {before.internal_variables.data(),
                                    groups > 1 ? before.tags.data() : nullptr, other.count_before},
                                   {now.internal_variables.data(), nullptr, leaves.count},
                                   sources.groups,
                                   list.data()});
    }
  }
};

}  // namespace pliant::detail
