#pragma once

#include <vector>

#include <pliant/body/bookkeeping.hpp>
#include <pliant/body/kernels.hpp>

namespace pliant {

/// The elements of one type in a body, and the groups they may belong to.
template <Backend B, Element E, class Formulations>
struct ElementTable;

template <Backend B, Element E, class... Fs>
struct ElementTable<B, E, detail::TypeList<Fs...>> {
  using element = E;
  using scalar = typename B::scalar;
  using Laws = GroupLaws<scalar, Fs...>;
  using formulations = detail::TypeList<Fs...>;
  static constexpr int groups = sizeof...(Fs);
  template <int G>
  using formulation = std::tuple_element_t<G, std::tuple<Fs...>>;
  /// The number of the group that a formulation has here.
  template <class F>
  static constexpr int group_of = detail::position_in<F>(formulations{});

  typename B::template Elements<E::nodes> elements;
  Laws laws;
  std::vector<Index> user_element;  // by the internal number
  Bookkeeping<B, groups> books;
  bool straight = false;  // all edges are, with their nodes in the middle

  Index count() const { return elements.count(); }

  /// Calls visit(std::integral_constant<Geometry, g>{}) with the cheapest geometry that is right.
  template <class Visit>
  void with_geometry(Visit const& visit) const {
    if constexpr (CurvedSimplex<E>)
      if (straight) return visit(std::integral_constant<Geometry, Geometry::straight>{});
    visit(std::integral_constant<Geometry, Geometry::isoparametric>{});
  }
};

}  // namespace pliant
