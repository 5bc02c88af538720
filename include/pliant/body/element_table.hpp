#pragma once

#include <algorithm>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/body/criteria_workspace.hpp>
#include <pliant/body/element_numbers.hpp>
#include <pliant/body/group.hpp>
#include <pliant/body/group_laws.hpp>
#include <pliant/body/when_asked.hpp>

namespace pliant {

/// How the nodes of elements of a type may be ordered.
template <Element E>
inline constexpr NodeOrder node_order =
    LinearSimplex<E> ? NodeOrder::any_even : NodeOrder::as_given;

/// The elements of one type in a layout, and the groups they may belong to.
template <Backend B, Element E, class Formulations>
struct ElementTable;

template <Backend B, Element E, class... Fs>
struct ElementTable<B, E, detail::TypeList<Fs...>> {
  using element = E;
  using scalar = typename B::scalar;
  using Laws = GroupLaws<scalar, Fs...>;
  using HostLaws = GroupLaws<double, Fs...>;
  using formulations = detail::TypeList<Fs...>;
  static constexpr int groups = sizeof...(Fs);
  template <int G>
  using formulation = std::tuple_element_t<G, std::tuple<Fs...>>;
  /// The number of the group that a formulation has here.
  template <class F>
  static constexpr int group_of = detail::position_in<F>(formulations{});

  typename B::template Elements<E::nodes> elements;
  Laws laws;
  WhenAsked<ElementNumbers> numbers;
  typename B::template Array<scalar> values;   // (values, elements)
  typename B::template Array<scalar> scratch;  // (elements), of whoever needs it
  CriteriaWorkspace<B> criteria;
  bool straight = false;  // all edges are, with their nodes in the middle

  Index count() const { return elements.count(); }
  /// The user's numbers, by the internal number.
  std::vector<Index> const& user_elements() const { return numbers->all(); }
  /// Of one element, without a look at the others.
  Index user_element(Index e) const { return (*numbers)[e]; }

  /// The rows of values per element, in the order of the backend's memory.
  std::vector<scalar> in_internal_order(std::vector<double> const& rows) const {
    std::vector<scalar> columns(rows.size());
    std::size_t const n = static_cast<std::size_t>(count()), width = n > 0 ? rows.size() / n : 0;
    if (width > 0) {
      auto const& user_element = user_elements();
      detail::for_each_on_host(static_cast<Index>(n), 16384, [&](Index i) {
        auto const e = static_cast<std::size_t>(i);
        for (std::size_t k = 0; k < width; ++k)
          columns[k * n + e] =
              static_cast<scalar>(rows[width * static_cast<std::size_t>(user_element[e]) + k]);
      });
    }
    return columns;
  }
  /// The groups of elements, in internal order.
  std::vector<Tag> tags_in_internal_order(std::vector<Tag> const& user) const {
    std::vector<Tag> internal(user.size(), 0);
    if constexpr (groups > 1)
      std::ranges::transform(user_elements(), internal.begin(),
                             [&](Index e) { return user[static_cast<std::size_t>(e)]; });
    return internal;
  }
  /// The inverse, of what an array holds.
  std::vector<Tag> tags_in_user_order(typename B::template Array<Tag> const& array) const {
    std::vector<Tag> user(static_cast<std::size_t>(count()), 0);
    if constexpr (groups > 1) {
      auto const internal = download<Tag>(array);
      auto const& user_element = user_elements();
      for (std::size_t e = 0; e < user.size(); ++e)
        user[static_cast<std::size_t>(user_element[e])] = internal[e];
    }
    return user;
  }
  /// The inverse of in_internal_order, of what an array holds.
  std::vector<double> in_user_order(typename B::template Array<scalar> const& array) const {
    auto const columns = download<scalar>(array);
    std::vector<double> rows(columns.size());
    auto const& user_element = user_elements();
    std::size_t const n = user_element.size(), width = n > 0 ? rows.size() / n : 0;
    for (std::size_t e = 0; e < n; ++e)
      for (std::size_t k = 0; k < width; ++k)
        rows[width * static_cast<std::size_t>(user_element[e]) + k] =
            static_cast<double>(columns[k * n + e]);
    return rows;
  }

  /// Calls visit(std::integral_constant<Geometry, g>{}) with the cheapest geometry that is right.
  template <class Visit>
  void with_geometry(Visit const& visit) const {
    if constexpr (CurvedSimplex<E>)
      if (straight) return visit(std::integral_constant<Geometry, Geometry::straight>{});
    visit(std::integral_constant<Geometry, Geometry::isoparametric>{});
  }
};

}  // namespace pliant
