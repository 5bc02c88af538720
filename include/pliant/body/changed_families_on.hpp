#pragma once

#include <concepts>
#include <cstddef>
#include <tuple>

#include <pliant/body/converted_elements_on.hpp>
#include <pliant/body/merged_elements.hpp>
#include <pliant/topology/refined_elements.hpp>
#include <pliant/topology/tets_of_pyramids.hpp>

// The families of elements that a refinement or a coarsening of a body's mesh changed in its backend's memory. `on`: the TopologyOn
// behind it.
namespace pliant::detail {

/// Those of one type that were refined, `done`.
template <Element E, class On, class Refined>
auto refined_families(On const& on, Refined const& done) {
  NodeField<double const, E::dim> const points{on.points.data()};
  auto const own = refined_elements<E>(on.tree, done, on.rows.of_node(), points, On::has_several);
  if constexpr (std::same_as<E, Pyramid5>) {
    using Tets = ComingTets<Tet4>;
    return WithTets<RefinedElements<E>, Tets>{own,
                                              Tets{own, own.count, ElementsByRows<Tet4>(points)}};
  } else {
    return own;
  }
}

/// The elements of type I that a change merged, of which `on` has what came out. `before`, `now`: the body's layouts.
template <std::size_t I, class On, class Layout>
auto merged_elements(On const& on, Layout const& before, Layout const& now) {
  using E = typename std::tuple_element_t<I, decltype(Layout::tables)>::element;
  return MergedElements<E>{
      on.leaves(I), on.order.merged_count(), std::get<I>(before.tables).elements.rows_of_nodes(),
      std::get<I>(now.tables).elements.rows_of_nodes(), ElementsByRows<E>({on.points.data()})};
}

/// The same with tetrahedra that were merged into pyramids beside them.
template <std::size_t I, class On, class Layout>
auto merged_families(On const& on, Layout const& before, Layout const& now) {
  using E = typename std::tuple_element_t<I, decltype(Layout::tables)>::element;
  auto const own = merged_elements<I>(on, before, now);
  if constexpr (std::same_as<E, Pyramid5>) {
    constexpr std::size_t tets = type_in<Tet4, typename On::M>;
    using Tets = GoingTets<Tet4, ConvertedPlaces>;
    return WithTets<MergedElements<E>, Tets>{
        own, Tets{on.converted_places(tets, I), own.count,
                  std::get<tets>(before.tables).elements.rows_of_nodes(),
                  ElementsByRows<Tet4>({on.points.data()})}};
  } else {
    return own;
  }
}

}  // namespace pliant::detail
