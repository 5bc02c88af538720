#pragma once

#include <cstddef>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>

#include <pliant/body/changed_parts_on.hpp>
#include <pliant/body/converted_elements_on.hpp>

namespace pliant::detail {

/// A body's parts behind a change of the degree of elements, or of their shape, in the backend's memory. `On` has the tree after it, and
/// follows.
template <class Parts>
class ConvertedPartsOn : ChangedPartsOn<Parts> {
  using Base = ChangedPartsOn<Parts>;
  using Base::at, Base::on_, Base::backend_, Base::parts_, Base::layout_, Base::energies_,
      Base::rows_, Base::topology_, Base::dim;
  using typename Base::B, typename Base::T, typename Base::Copies, typename Base::Energies,
      typename Base::On, typename Base::Layout;
  using Split = typename TreeOn<B>::Split;
  template <std::size_t I>
  using ElementOf = typename Base::template ElementOf<I>;
  template <class U>
  using Array = typename Parts::template Array<U>;
  using List = std::shared_ptr<Array<Index>>;

 public:
  using Base::Base;

  ChangedTopology<Parts> changed(Raised const& done) {
    auto const follow = [&] {
      on_->hanging.find(on_->tree);
      convert_order(Conversion::degree, done.cells, done.raised);
      on_->rows.extend(on_->tree, on_->order, done);
    };
    return converted(
        copy_of(done.cells, done.raised), ChangeOfCells::raise, follow,
        [&](auto&... what) { fill(done, what...); }, [&](auto* held) { hold_all(held); },
        [](auto const&...) {});
  }
  ChangedTopology<Parts> changed(Lowered const& done) {
    auto const follow = [&] {
      on_->hanging.find(on_->tree);
      convert_order(Conversion::degree, done.lowered_cells, done.lowered);
      on_->rows.coarsen(done);
    };
    return converted(
        copy_of(done.lowered_cells, done.lowered), ChangeOfCells::lower, follow,
        [](auto const&...) {}, [&](auto* held) { hold_all(held); },
        [&](auto&... what) { this->clear_gone(what...); });
  }
  ChangedTopology<Parts> changed(Split const& done) {
    auto cells = std::make_shared<Array<Index>>(unset<Index>(backend_, at(done.leaves)));
    backend_.for_each(done.leaves, SplitOfCell{done.cells, cells->data()});
    auto const follow = [&] {
      on_->hanging.find_after(on_->tree, done);
      convert_order(Conversion::split, done);
      on_->rows.extend(on_->tree, on_->order, done);
    };
    auto const hold = [&](DirectionMask* held) {
      on_->held.refine(backend_, on_->tree, done, on_->rows.of_node(), rows_, held);
    };
    return converted(
        std::move(cells), ChangeOfCells::split, follow, [&](auto&... what) { fill(done, what...); },
        hold, [](auto const&...) {});
  }
  ChangedTopology<Parts> changed(Merged const& done) {
    auto const follow = [&] {
      on_->hanging.find_after(on_->tree, done);
      convert_order(Conversion::merge, done);
      on_->rows.coarsen(done);
    };
    return converted(
        copy_of(done.parents, done.merged), ChangeOfCells::merge, follow, [](auto const&...) {},
        [&](auto* held) { hold_all(held); }, [&](auto&... what) { this->clear_gone(what...); });
  }

 private:
  [[nodiscard]] List copy_of(Index const* cells, Index count) const {
    auto list = std::make_shared<Array<Index>>(unset<Index>(backend_, at(count)));
    copy_values<B, Index>(backend_, cells, list->data(), at(count));
    return list;
  }
  void convert_order(Conversion how, auto const&... what) {
    on_->convert_order(backend_, how, *parts_.layout.first_order, what...);
  }
  /// Gives the nodes that a change made their values.
  template <class Made>
  void fill(Made const& done, Layout& layout, Array<T>& u, Array<T>& v) {
    LoopStep const placing{done.new_nodes, PlaceAtRest<T, dim>{done.nodes,
                                                               on_->rows.of_node(),
                                                               {on_->points.data()},
                                                               layout.middle,
                                                               node_field<dim>(layout.rest)}};
    on_types<On::types>([&]<std::size_t... I>(TypeNumber<I>...) {
      in_turn(backend_,
              filling_new_nodes<ElementOf<I>>(on_->tree, done, On::has_several, on_->rows.of_node(),
                                              on_->point_field(), node_field<dim>(u),
                                              node_field<dim>(v))...,
              placing);
    });
  }
  void hold_all(DirectionMask* held) {
    on_->held.extend(backend_, rows_);
    on_->held.hold(backend_, on_->tree, on_->rows.of_node(), rows_, held);
  }

  template <std::size_t From, std::size_t To>
  auto families(Layout const& layout) const {
    using E = ElementOf<From>;
    using F = ElementOf<To>;
    auto const places = on_->converted_places(From, To);
    return ConvertedElements<E, F>{places.count,
                                   places,
                                   std::get<From>(parts_.layout.tables).elements.rows_of_nodes(),
                                   std::get<To>(layout.tables).elements.rows_of_nodes(),
                                   ElementsByRows<E>(this->at_rest()),
                                   ElementsByRows<F>(this->at_rest()),
                                   on_->rows.node()};
  }
  /// f(families...), of all pairs of types of which elements of one become such of the other.
  template <class F>
  auto with_families(Layout const& layout, F const& f) const {
    return on_types<On::types * On::types>([&]<std::size_t... P>(TypeNumber<P>...) {
      auto const one = [&]<std::size_t Pair>(TypeNumber<Pair>) {
        constexpr std::size_t from = Pair / On::types, to = Pair % On::types;
        if constexpr (interchange<ElementOf<from>, ElementOf<to>>)
          return std::tuple(families<from, to>(layout));
        else
          return std::tuple();
      };
      return std::apply(f, std::tuple_cat(one(TypeNumber<P>{})...));
    });
  }

  /// `cells`: those that change; follow(): puts what hangs, elements and rows in order; fill(layout, u, v): gives new nodes their values;
  /// hold(directions by row): holds nodes; clear(layout, u, v, load, families...): see clear_gone.
  template <class Follow, class Fill, class Hold, class Clear>
  ChangedTopology<Parts> converted(List cells, ChangeOfCells change, Follow const& follow,
                                   Fill const& fill, Hold const& hold, Clear const& clear) {
    synchronize_velocities(parts_);
    energies_.clearing().run(backend_);
    energies_.add_kinetic(Energies::before, parts_);
    this->follow_on_host(std::move(cells), change);
    follow();
    double const speed = this->largest_speed();  // waits
    on_->follow_order(true);
    rows_ = on_->rows.count();
    Copies copies(backend_);
    auto points = copies.template extended<double>(on_->points, this->values());
    auto u = copies.template extended<T>(parts_.state.u, this->values());
    auto v = copies.template extended<T>(parts_.state.v, this->values());
    auto load = this->extended_load(copies);
    layout_.converts = true;
    auto layout = layout_.make(copies, topology_, hold);
    on_->points = std::move(points);
    on_->masses.extend(rows_);
    fill(layout, u, v);
    MassWeightsOn<B> const weights(backend_, layout.interpolation, rows_);
    with_families(layout, [&](auto const&... families) {
      this->exchange_masses(weights, layout, speed, v, families...);
      clear(layout, u, v, load, families...);
    });
    auto changed = this->parts_with(std::move(layout), std::move(u), std::move(v), std::move(load));
    convert_points(changed.parts);
    changed.changed_rows = with_families(changed.parts.layout, [&](auto const&... families) {
      return changed_rows(parts_, rows_, true, families...);
    });
    on_types<On::types>([&]<std::size_t... I>(TypeNumber<I>...) {
      energies_.add_strain_of_merged(parts_, changed.parts, {on_->leaves(I)...});
    });
    this->read_energies(changed);
    changed.taken = on_->momentum.taken();
    return changed;
  }
  /// Gives elements of another degree what their points kept.
  void convert_points(Parts& next) {
    on_types<On::types * On::types>([&]<std::size_t... P>(TypeNumber<P>...) {
      auto const one = [&]<std::size_t Pair>(TypeNumber<Pair>) {
        constexpr std::size_t from = Pair / On::types, to = Pair % On::types;
        if constexpr (differ_in_degree<ElementOf<from>, ElementOf<to>>)
          convert_points<from, to>(next);
      };
      (one(TypeNumber<P>{}), ...);
    });
  }
  template <std::size_t From, std::size_t To>
  void convert_points(Parts& next) {
    using Source = typename Base::template Table<From>;
    using Target = typename Base::template Table<To>;
    if constexpr (Source::Laws::internal_variable_count > 0 &&
                  Target::Laws::internal_variable_count > 0) {
      constexpr std::size_t groups{Source::groups};
      static auto const sources = converted_sources<Source, Target>();
      auto const list = upload(backend_, sources.points);
      auto const& before = std::get<From>(parts_.state.elements);
      auto& now = std::get<To>(next.state.elements);
      auto const places = on_->converted_places(From, To);
      backend_.for_each(
          places.count,
          ConvertPoints<T, groups>{places,
                                   {before.internal_variables.data(),
                                    groups > 1 ? before.tags.data() : nullptr, places.count_before},
                                   {now.internal_variables.data(), nullptr, places.now.count},
                                   sources.groups,
                                   list.data()});
    }
  }
};

}  // namespace pliant::detail
