#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>

#include <pliant/backend/element_sums.hpp>
#include <pliant/backend/grown_array.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/change_passes.hpp>
#include <pliant/body/element_rows_on.hpp>
#include <pliant/body/finite_fields.hpp>
#include <pliant/force/element_kernels.hpp>

namespace pliant::detail {

/// Energies of a body before and after a change of its mesh, summed in the backend's memory and read all at once.
template <class Parts>
class EnergySumsOn {
  using B = typename Parts::backend_type;
  using T = typename Parts::T;
  template <std::size_t I>
  using Table = std::tuple_element_t<I, decltype(Parts::layout_type::tables)>;
  static constexpr int dim = Parts::dim;
  static constexpr std::size_t types = std::tuple_size_v<decltype(Parts::layout_type::tables)>;
  static constexpr std::size_t sums = 4;
  using Array = typename Parts::template Array<double>;

 public:
  enum Time : std::size_t { before, after };
  /// J, by the time; kinetic energies are not finite where displacements or velocities are not.
  struct Sums {
    std::array<double, 2> strain, kinetic;
  };

  /// `room`: for them, in the backend's memory.
  EnergySumsOn(B const& backend, Array& room) : backend_(backend), sums_(room) {
    grow(backend, room, sums);
  }
  /// A step of loops (see in_turn) before all others.
  [[nodiscard]] LoopStep<FillValue<double>> clearing() {
    return {static_cast<Index>(sums), {sums_.data(), 0}};
  }

  /// Of the elements of a body's type I at some places, (count); −1 for none.
  template <std::size_t I>
  void add_strain_at(Time time, Parts const& of, Index const* places, Index count) {
    add<I>(time, of, [&](auto const& table, Tag const* tags, auto const&... arguments) {
      add_sum_elements_at<Table<I>::groups>(backend_, table, tags, places, count, arguments...);
    });
  }
  /// Before and after a coarsening, of what it merged, and of other elements with nodes that it displaced: those that hang, where they
  /// began to, or hang on others that did. `leaves`: by the type.
  void add_strain_of_merged(Parts const& parts, Parts const& now,
                            std::array<LeavesView, types> const& leaves) {
    using Values = NodeField<T const, dim>;
    auto displaced = zeros<std::uint8_t>(backend_, static_cast<std::size_t>(now.layout.rows));
    auto const& slaves = now.layout.interpolation.slaves();
    backend_.for_each(
        slaves.count,
        MarkDisplaced<T, dim>{slaves.node.data(), parts.layout.rows, Values{parts.state.u.data()},
                              Values{now.state.u.data()}, displaced.data()});
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (add_strain_of_others<I>(before, parts, IsMergedLeaf{leaves[I]}, displaced.data()), ...);
      (add_strain_of_others<I>(after, now, IsNewLeaf{leaves[I]}, displaced.data()), ...);
    }(std::make_index_sequence<types>());
  }
  /// Velocities have to be of the present time.
  void add_kinetic(Time time, Parts const& parts) {
    backend_.add_sum(parts.layout.rows, kinetic_energy_of_finite_nodes(parts),
                     sums_.data() + 2 + time);
  }
  [[nodiscard]] Sums read() const {
    std::array<double, sums> s;
    sums_.download(s);
    return {{s[0], s[1]}, {s[2], s[3]}};
  }

 private:
  template <std::size_t I, class IsOther>
  void add_strain_of_others(Time time, Parts const& of, IsOther const& is_other,
                            std::uint8_t const* displaced) {
    IsOtherOrDisplaced<Table<I>::element::nodes, IsOther> const meets{
        is_other, std::get<I>(of.layout.tables).elements.rows_of_nodes(), displaced};
    add<I>(time, of, [&](auto const& table, Tag const* tags, auto const&... arguments) {
      add_sum_elements_if<Table<I>::groups>(backend_, table, tags, meets, arguments...);
    });
  }
  /// add_some(table, its tags, rows, kernel, sum, fields...): of some elements. Of all instead, where laws read what is kept by the
  /// number of an element, and a backend sums over copies.
  template <std::size_t I, class AddSome>
  void add(Time time, Parts const& of, AddSome const& add_some) {
    auto const& table = std::get<I>(of.layout.tables);
    auto const rest = node_field<dim>(of.layout.rest), u = node_field<dim>(of.state.u);
    table.with_geometry([&](auto geometry) {
      EnergyKernel<typename Table<I>::Laws, geometry.value> const kernel{table.laws};
      if constexpr (Table<I>::Laws::reads_elements && !sums_at_places<B>)
        add_sum_elements<Table<I>::groups>(backend_, table.elements, kernel, sums_.data() + time,
                                           rest, u);
      else
        add_some(table.elements, std::get<I>(of.state.elements).tags.data(), of.layout.rows, kernel,
                 sums_.data() + time, rest, u);
    });
  }

  B const& backend_;
  Array& sums_;
};

}  // namespace pliant::detail
