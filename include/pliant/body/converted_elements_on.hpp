#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/body/carried_points_on.hpp>
#include <pliant/body/converted_elements.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/topology/changed_elements.hpp>
#include <pliant/topology/element_types.hpp>

// Elements that get another degree in a backend's memory: they are of another type then.
namespace pliant::detail {

/// Whether a change of degree makes elements of one type of those of the other.
template <Element From, Element To>
inline constexpr bool differ_in_degree =
    std::same_as<typename From::cell, typename To::cell> && From::degree != To::degree;

/// Where elements of a type were before that were of another one.
struct PlacesOfConverted {
  LeavesView now;                            // of the type
  Index first_before = 0, count_before = 0;  // of the other one

  /// The place of the element at a place now, among the other type's; −1: it is none of these.
  [[nodiscard]] PLIANT_HOST_DEVICE Index operator()(Index i) const {
    if (!now.comes_from_others(i)) return -1;
    Index const place = now.from_all[i] - first_before;
    return place >= 0 && place < count_before ? place : -1;
  }
};
inline PlacesOfConverted places_of_converted(LeavesView const& now, LeavesView const& other) {
  return {now, other.first_before, other.count_before};
}

/// Those of listed cells that were elements of one type and are of another one, for loops of a backend: ChangedFamilies of one each.
template <Element From, Element To>
struct ConvertedElements {
  using gone_element = From;
  using come_element = To;
  static constexpr Index most_gone = 1, most_come = 1;

  Index const* cells;
  Index count;
  PlacesOfConverted places;
  ElementRows before,
      now;  // the rows of nodes of either type's elements, by their places before and now
  ElementsByRows<From> gone_elements;
  ElementsByRows<To> come_elements;

  [[nodiscard]] PLIANT_HOST_DEVICE Index gone(Index r) const {
    return place_before(r) >= 0 ? 1 : 0;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Index come(Index r) const { return gone(r); }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<From> rows_gone(Index r, Index) const {
    return taken_rows<From>(before[place_before(r)]);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<To> rows_come(Index r, Index) const {
    return taken_rows<To>(now[place(r)]);
  }

 private:
  /// Of another type's elements too.
  [[nodiscard]] PLIANT_HOST_DEVICE Index place(Index r) const {
    return places.now.places[cells[r]] - places.now.first;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Index place_before(Index r) const {
    Index const own = place(r);
    return own >= 0 && own < places.now.count ? places(own) : -1;
  }
};

/// Gives converted elements their groups by those that they were in; without these, all were in the first.
template <std::size_t Groups>
struct ConvertTags {
  PlacesOfConverted places;
  Tag const* before;
  Tag* now;
  std::array<Tag, Groups> to;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (Index const p = places(i); p >= 0)
      now[i] = to[before != nullptr ? static_cast<std::size_t>(before[p]) : 0];
  }
};
/// Gives them the values that their laws read: each from a column of the other type's.
template <class T, std::size_t Columns>
struct ConvertValues {
  PlacesOfConverted places;
  T const* before;
  T* now;
  std::array<int, Columns> column;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const p = places(i);
    if (p < 0) return;
    for (std::size_t k = 0; k < Columns; ++k)
      now[static_cast<std::ptrdiff_t>(places.now.count) * static_cast<std::ptrdiff_t>(k) + i] =
          before[static_cast<std::ptrdiff_t>(places.count_before) * column[k] + p];
  }
};

/// From which points those of converted elements take what they keep, by the group that these were in: from the nearest ones, as
/// carried_points has it.
template <std::size_t Groups>
struct ConvertedSources {
  struct Own {
    Index points = 0,
          size = 0;   // of the group now; size: numbers that each keeps; 0: they keep nothing
    Index first = 0;  // of `points`
  };
  std::array<Own, Groups> groups{};
  std::vector<Index> points;  // of the group before
};
template <class From, class To>
ConvertedSources<std::size_t{From::groups}> converted_sources() {
  ConvertedSources<std::size_t{From::groups}> sources;
  constexpr auto to = converted_groups<From, To>();
  auto const add = [&]<int G>(std::integral_constant<int, G>) {
    auto const own = points_of<typename From::template formulation<G>>();
    auto const now =
        points_of<typename To::template formulation<static_cast<int>(to[std::size_t{G}])>>();
    if (now.size == 0) return;
    sources.groups[std::size_t{G}] = {static_cast<Index>(now.places.size()), now.size,
                                      static_cast<Index>(sources.points.size())};
    for (auto const& at : now.places) {
      NearestPlace nearest;
      Index from = 0;
      for (std::size_t p = 0; p < own.places.size(); ++p)
        if (nearest.is_nearer(own.places[p], at)) from = static_cast<Index>(p);
      sources.points.push_back(from);
    }
  };
  [&]<int... G>(std::integer_sequence<int, G...>) {
    (add(std::integral_constant<int, G>{}), ...);
  }(std::make_integer_sequence<int, From::groups>());
  return sources;
}
/// Whether points of converted elements keep what these kept, in each group: else they would have to be brought to rest.
template <class From, class To>
inline constexpr bool points_go_along = []<int... G>(std::integer_sequence<int, G...>) {
  constexpr auto to = converted_groups<From, To>();
  return ((same_law<typename From::template formulation<G>,
                    typename To::template formulation<static_cast<int>(to[std::size_t{G}])>> ||
           internal_variables_of<
               typename To::template formulation<static_cast<int>(to[std::size_t{G}])>> == 0) &&
          ...);
}(std::make_integer_sequence<int, From::groups>());

/// Whether the other type's groups have all values that these read.
template <class From, class To>
inline constexpr bool values_go_along = []<int... H>(std::integer_sequence<int, H...>) {
  auto const is_read = []<class F, int... G>(std::type_identity<F>,
                                             std::integer_sequence<int, G...>) {
    return element_values<F> == 0 || (same_law<F, typename From::template formulation<G>> || ...);
  };
  return (is_read(std::type_identity<typename To::template formulation<H>>{},
                  std::make_integer_sequence<int, From::groups>()) &&
          ...);
}(std::make_integer_sequence<int, To::groups>());

template <class T, std::size_t Groups>
struct ConvertPoints {
  PlacesOfConverted places;
  PointsView<T const> before;
  PointsView<T> now;
  std::array<typename ConvertedSources<Groups>::Own, Groups> groups;
  Index const* points;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Index const p = places(i);
    if (p < 0) return;
    auto const& own = groups[static_cast<std::size_t>(before.tag(p))];
    for (Index q = 0; q < own.points; ++q)
      for (Index k = 0; k < own.size; ++k)
        now.at(i, own.size * q + k) = before.at(p, own.size * points[own.first + q] + k);
  }
};

}  // namespace pliant::detail
