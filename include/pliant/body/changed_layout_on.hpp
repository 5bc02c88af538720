#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>

#include <pliant/backend/array_copies.hpp>
#include <pliant/backend/elements_of_rows.hpp>
#include <pliant/body/change_on_backend.hpp>
#include <pliant/body/converted_elements_on.hpp>
#include <pliant/body/element_rows_on.hpp>

namespace pliant::detail {

template <std::size_t I>
using TypeNumber = std::integral_constant<std::size_t, I>;
/// f(TypeNumber<I>{}...) of so many element types.
template <std::size_t Types, class F>
constexpr decltype(auto) on_types(F const& f) {
  return [&]<std::size_t... I>(std::index_sequence<I...>) -> decltype(auto) {
    return f(TypeNumber<I>{}...);
  }(std::make_index_sequence<Types>());
}

/// The layout of a body behind a change of its mesh in the backend's memory. `On` has the tree after it, and orders of elements and
/// nodes.
template <class Parts>
class ChangedLayoutOn {
  using B = typename Parts::backend_type;
  using M = typename Parts::mesh_type;
  using T = typename Parts::T;
  using Layout = typename Parts::layout_type;
  template <std::size_t I>
  using Table = std::tuple_element_t<I, decltype(Layout::tables)>;
  using On = TopologyOn<M, B>;
  using Copies = ArrayCopies<B>;
  static constexpr int dim = Parts::dim;
  static constexpr Index few_hung = 2048;  // edges and sides on which nodes hang
  template <class U>
  using Array = typename Parts::template Array<U>;

 public:
  ChangedLayoutOn(Parts const& parts, std::shared_ptr<On> on)
      : parts_(parts), on_(std::move(on)), backend_(parts.backend) {}

  /// Whether elements go over to other types in the change.
  bool converts = false;

  /// Behind a change, with all but masses, which are not set; what it takes of rows is that of before. Makes the copies. hold(a copy
  /// of what was held before): holds what is held now, before patches are planned, beside which loops over all take longer.
  template <class Hold>
  Layout make(Copies& copies, WhenAsked<Topology<M>> const& topology, Hold const& hold) {
    rows_ = on_->rows.count();
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
    layout.rest = copies.template extended<T>(before.rest, node_stride * at(rows_));
    layout.held = copies.template extended<DirectionMask>(before.held, at(rows_));
    copies.make();
    hold(layout.held.data());
    // The masters of a few are found while the host plans patches, which those of many would keep waiting.
    auto& hanging = on_->hanging;
    bool const are_few = hanging.count_found() <= few_hung;
    if (are_few) hanging.find_masters(on_->tree);
    on_types<On::types>(
        [&]<std::size_t... I>(TypeNumber<I>...) { (make_table<I>(layout, topology), ...); });
    if (!are_few) hanging.find_masters(on_->tree);
    layout.mass = unset<T>(backend_, at(rows_));
    backend_.synchronize();
    layout.interpolation = hanging.interpolation(on_->tree, on_->rows.of_node(), rows_);
    return layout;
  }
  /// Reads the masses of nodes, and rounds them for such a layout. `weights`: of its slaves.
  void read_masses(Layout& layout, MassWeightsOn<B> const& weights) {
    *own_masses_ = unset<ExactSum>(backend_, at(rows_));
    on_->masses.read(weights, kilograms_->data(), own_masses_->data());
    on_->masses.round(kilograms_->data(), layout.mass.data());
  }
  /// kg, by the row, when these were read.
  [[nodiscard]] double const* kilograms() const { return kilograms_->data(); }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  template <std::size_t I>
  void make_table(Layout& layout, WhenAsked<Topology<M>> const& topology) {
    using E = typename Table<I>::element;
    using Elements = typename B::template Elements<E::nodes>;
    auto& table = std::get<I>(layout.tables);
    auto const& before = std::get<I>(parts_.layout.tables);
    auto const leaves = on_->leaves(I);
    auto blocks = blocks_after_change(on_->first_of_block(I), parts_.layout.first_of_block[I],
                                      on_->staying_in(I));
    auto rows = element_rows<E, row_width<Elements>>(
        backend_, on_->tree.view(), leaves, on_->rows.of_node(), before.elements.rows_of_nodes());
    Array<Tag> tags;
    if constexpr (Table<I>::groups > 1)
      tags =
          inherited_values<Tag>(backend_, leaves, std::get<I>(parts_.state.elements).tags.data());
    if constexpr (Table<I>::groups > 1)
      from_other_types<I>([&]<std::size_t J>(TypeNumber<J>, ConvertedPlaces const& places) {
        using From = typename Table<J>::element;
        backend_.for_each(places.count,
                          ConvertTags<std::size_t{Table<J>::groups}, most_parts<E, From>>{
                              places, tags_of<J>(), tags_of<I>(), tags.data(),
                              converted_groups<Table<J>, Table<I>>()});
      });
    table.elements =
        elements_of_rows<Elements>(backend_, std::move(rows), Table<I>::groups, std::move(tags),
                                   rows_, node_order<E>, blocks, &before.elements);
    table.laws = before.laws;
    // Children have their parent's, so that those of a family are equal.
    constexpr Index values_of_each = Table<I>::Laws::value_count;
    if constexpr (values_of_each > 0) {
      table.values = inherited_values<T>(backend_, leaves, before.values.data(), values_of_each);
      from_other_types<I>([&]<std::size_t J>(TypeNumber<J>, ConvertedPlaces const& places) {
        std::array<int, std::size_t{values_of_each}> column{};
        std::ranges::copy(places_of_values<Table<J>, Table<I>>(), column.begin());
        backend_.for_each(places.count, ConvertValues<T, std::size_t{values_of_each}>{
                                            places, std::get<J>(parts_.layout.tables).values.data(),
                                            table.values.data(), column});
      });
    }
    table.straight = before.straight;
    table.numbers = WhenAsked<ElementNumbers>::by(
        [topology, order = parts_.layout.first_order, first = blocks.first] {
          auto ordered = elements_in_order(*topology, *order);
          return std::make_shared<ElementNumbers>(std::move(ordered.cells[I]), first,
                                                  topology->cells[I]);
        });
    layout.first_of_block[I] = std::move(blocks.first);
  }

  template <std::size_t J>
  [[nodiscard]] Tag const* tags_of() const {
    return Table<J>::groups > 1 ? std::get<J>(parts_.state.elements).tags.data() : nullptr;
  }
  /// visit(TypeNumber<J>{}, families of elements of type J of which such of type I are made) for all types J, where there are some.
  template <std::size_t I, class Visit>
  void from_other_types(Visit const& visit) const {
    if (!converts) return;
    on_types<On::types>([&]<std::size_t... J>(TypeNumber<J>...) {
      auto const look_at = [&]<std::size_t Other>(TypeNumber<Other> other) {
        if constexpr (interchange<typename Table<Other>::element, typename Table<I>::element>)
          visit(other, on_->converted_places(Other, I));
      };
      (look_at(TypeNumber<J>{}), ...);
    });
  }

  Parts const& parts_;
  std::shared_ptr<On> on_;
  B const& backend_;
  Index rows_ = 0;
  std::shared_ptr<Array<ExactSum>> own_masses_;
  std::shared_ptr<Array<double>> kilograms_;
};

}  // namespace pliant::detail
