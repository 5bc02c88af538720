#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/body/carried_points_on.hpp>
#include <pliant/body/converted_elements.hpp>
#include <pliant/body/element_rows_on.hpp>
#include <pliant/body/leaf_order_on.hpp>
#include <pliant/topology/changed_elements.hpp>
#include <pliant/topology/element_types.hpp>
#include <pliant/topology/tets_of_pyramids.hpp>

// Elements that get another degree, are split or merged in a backend's memory: they, or what comes for them, are of another type then.
namespace pliant::detail {

/// Whether a change of degree makes elements of one type of those of the other.
template <Element From, Element To>
inline constexpr bool differ_in_degree =
    std::same_as<typename From::cell, typename To::cell> && From::degree != To::degree;
/// Whether a change of shape does.
template <Element From, Element To>
inline constexpr bool differ_in_shape =
    std::same_as<SplitInto<From>, To> || std::same_as<SplitInto<To>, From>;

/// Into how many elements of one type such of another one are made, at most: of pyramids two tetrahedra where they are split, four beside
/// other pyramids where they are refined.
template <Element From, Element To>
inline constexpr Index most_parts = !std::same_as<SplitInto<From>, To>                 ? 1
                                    : std::same_as<typename From::cell, Quadrilateral> ? 4
                                    : std::same_as<typename From::cell, Hexahedron>    ? 6
                                                                                       : 4;
/// How many elements of an element's own type such may be merged with.
inline constexpr Index most_beside = pyramids_of_pyramid;

/// Families of a change that are elements of one type now and were of another one before, by their places among these.
struct ConvertedPlaces {
  ConvertedFamily const* families;
  Index count;
  LeavesView now;                            // of the type
  Index first_before = 0, count_before = 0;  // of the other one

  /// Whether family r is one of these.
  [[nodiscard]] PLIANT_HOST_DEVICE bool has(Index r) const {
    Index const place = now_at(r), own = before_at(r);
    return place >= 0 && place < now.count && own >= 0 && own < count_before;
  }
  /// The places of its first element before and now, if it is.
  [[nodiscard]] PLIANT_HOST_DEVICE Index before_at(Index r) const {
    return families[r].first_before - first_before;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Index now_at(Index r) const {
    return now.places[families[r].cell] - now.first;
  }
  /// How many elements of the type itself are merged with those of the other one.
  [[nodiscard]] PLIANT_HOST_DEVICE Index children(Index r) const {
    return now.merged > 0 ? now.children(r) : 0;
  }
};

/// Families that were elements of one type and are of another one, for loops of a backend: ChangedFamilies; those of other types have
/// no elements.
template <Element From, Element To>
struct ConvertedElements {
  using gone_element = From;
  using come_element = To;
  static constexpr Index most_gone = most_parts<To, From>, most_come = most_parts<From, To>;

  Index count;
  ConvertedPlaces places;
  ElementRows before,
      now;  // the rows of nodes of either type's elements, by their places before and now
  ElementsByRows<From> gone_elements;
  ElementsByRows<To> come_elements;
  Index const* node = nullptr;  // by row: the user's number

  [[nodiscard]] PLIANT_HOST_DEVICE Index gone(Index r) const {
    return places.has(r) ? places.families[r].gone : 0;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE Index come(Index r) const {
    return places.has(r) ? places.families[r].come : 0;
  }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<From> rows_gone(Index r, Index k) const {
    return taken_rows<From>(before[places.before_at(r) + k]);
  }
  [[nodiscard]] PLIANT_HOST_DEVICE RowsOfElement<To> rows_come(Index r, Index k) const {
    return taken_rows<To>(now[places.now_at(r) + k]);
  }
  /// A row that two pyramids have which are split or merged together: where their base is not plane, volume goes over from one to the
  /// other, and momentum is counted from the velocity there.
  [[nodiscard]] PLIANT_HOST_DEVICE Index base_row(Index r) const
    requires(std::same_as<From, Pyramid5> || std::same_as<To, Pyramid5>) &&
            (std::same_as<From, Tet4> || std::same_as<To, Tet4>)
  {
    auto const first_of = [&](auto const& rows) {
      Index found = rows[0];
      for (std::size_t k = 1; k < 4; ++k)
        if (node[rows[k]] < node[found]) found = rows[k];
      return found;
    };
    if constexpr (std::same_as<From, Pyramid5>)
      return first_of(rows_gone(r, 0));
    else
      return first_of(rows_come(r, 0));
  }
};

/// Gives converted elements their groups by those that they were in, of merged ones the most frequent, as Transfer does; without
/// these, all were in the first.
template <std::size_t Groups, Index MostGone>
struct ConvertTags {
  ConvertedPlaces places;
  Tag const *before, *before_of_own;  // of the other type, and the type's own
  Tag* now;
  std::array<Tag, Groups> to;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    if (!places.has(r)) return;
    auto const& family = places.families[r];
    Tag own[MostGone + most_beside];
    Index count = 0;
    for (; count < places.children(r); ++count)
      own[count] = before_of_own[places.now.first_child_before(r) + count];
    for (Index k = 0; k < family.gone; ++k)
      own[count++] =
          to[before != nullptr ? static_cast<std::size_t>(before[places.before_at(r) + k]) : 0];
    Tag const tag = merged_value(own, static_cast<Tag const*>(nullptr), count);
    for (Index k = 0; k < family.come; ++k) now[places.now_at(r) + k] = tag;
  }
};
/// Gives them the values that their laws read, each from a column of the other type's. Those of a family are equal, since children have
/// their parent's.
template <class T, std::size_t Columns>
struct ConvertValues {
  ConvertedPlaces places;
  T const* before;
  T* now;
  std::array<int, Columns> column;

  PLIANT_HOST_DEVICE void operator()(Index r) const {
    if (!places.has(r)) return;
    for (std::size_t c = 0; c < Columns; ++c) {
      T const value = before[static_cast<std::ptrdiff_t>(places.count_before) * column[c] +
                             places.before_at(r)];
      T* const of_column =
          now + static_cast<std::ptrdiff_t>(places.now.count) * static_cast<std::ptrdiff_t>(c);
      for (Index k = 0; k < places.families[r].come; ++k) of_column[places.now_at(r) + k] = value;
    }
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
  ConvertedPlaces places;
  PointsView<T const> before;
  PointsView<T> now;
  std::array<typename ConvertedSources<Groups>::Own, Groups> groups;
  Index const* points;
  PLIANT_HOST_DEVICE void operator()(Index r) const {
    if (!places.has(r)) return;
    Index const p = places.before_at(r), i = places.now_at(r);
    auto const& own = groups[static_cast<std::size_t>(before.tag(p))];
    for (Index q = 0; q < own.points; ++q)
      for (Index k = 0; k < own.size; ++k)
        now.at(i, own.size * q + k) = before.at(p, own.size * points[own.first + q] + k);
  }
};

}  // namespace pliant::detail
