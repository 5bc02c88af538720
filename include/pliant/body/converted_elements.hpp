#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include <pliant/body/element_table.hpp>
#include <pliant/body/groups.hpp>
#include <pliant/topology/plan.hpp>

// What elements take along into another type: their group and the values that their law reads.
namespace pliant::detail {

template <class F, class G>
inline constexpr bool same_law =
    std::same_as<typename F::template law<double>, typename G::template law<double>>;

/// Whether elements of one table may go over to another.
template <class From, class To>
inline constexpr bool are_convertible = interchange<typename From::element, typename To::element>;

/// The group that elements of a group of one table go to in another: the first of the same law, or the first of all.
template <class From, class To>
constexpr std::array<Tag, static_cast<std::size_t>(From::groups)> converted_groups() {
  std::array<Tag, static_cast<std::size_t>(From::groups)> groups{};
  auto const find = [&]<int G, int... H>(std::integral_constant<int, G>,
                                         std::integer_sequence<int, H...>) {
    bool found = false;
    ((!found &&
              same_law<typename From::template formulation<G>, typename To::template formulation<H>>
          ? (found = true, groups[std::size_t{G}] = Tag{H})
          : Tag{}),
     ...);
  };
  [&]<int... G>(std::integer_sequence<int, G...>) {
    (find(std::integral_constant<int, G>{}, std::make_integer_sequence<int, To::groups>()), ...);
  }(std::make_integer_sequence<int, From::groups>());
  return groups;
}

/// For each value that laws of a table read, its place among those of another table's groups of the same laws; −1 where
/// there is none.
template <class From, class To>
std::vector<int> places_of_values() {
  std::vector<int> places;
  [&]<int... H>(std::integer_sequence<int, H...>) {
    auto const find = [&]<class F>(F const*) {
      constexpr int width = element_values<F>;
      int first = -1, next = 0;
      [&]<int... G>(std::integer_sequence<int, G...>) {
        auto const look_at = [&]<class Other>(Other const*) {
          if (first < 0 && same_law<F, Other>) first = next;
          next += element_values<Other>;
        };
        (look_at(static_cast<typename From::template formulation<G> const*>(nullptr)), ...);
      }(std::make_integer_sequence<int, From::groups>());
      for (int k = 0; k < width; ++k) places.push_back(first < 0 ? -1 : first + k);
    };
    (find(static_cast<typename To::template formulation<H> const*>(nullptr)), ...);
  }(std::make_integer_sequence<int, To::groups>());
  return places;
}

/// The groups of the elements of a type on a new mesh, by the user's number. `groups`: of all types, before.
template <class Table, class Parts>
std::vector<Tag> carried_groups(Parts const& parts, std::vector<std::vector<Tag>> const& groups,
                                Transfer<Parts::dim> const& transfer, std::size_t type) {
  std::vector<std::vector<Tag>> converted(groups.size());
  std::size_t from = 0;
  parts.for_each_type([&](auto const& table, auto const&) {
    using From = std::remove_cvref_t<decltype(table)>;
    std::size_t const old = from++;
    if constexpr (!std::same_as<From, Table> && are_convertible<From, Table>) {
      if (!transfer.comes_from(type, old)) return;
      constexpr auto to = converted_groups<From, Table>();
      for (Tag const tag : groups[old]) converted[old].push_back(to[tag]);
    }
  });
  return transfer.carry_elements_from(
      [&](std::size_t old) -> std::vector<Tag> const& {
        return old == type ? groups[old] : converted[old];
      },
      type);
}

/// Whether a group sets the values of new elements by their places.
template <class Parts>
bool sets_values_by_place(Parts const& parts) {
  return std::apply(
      []<class... F>(Group<F> const&... groups) {
        auto const does = []<class G>(Group<G> const& group) {
          if constexpr (element_values<G> > 0)
            return static_cast<bool>(group.values_at);
          else
            return false;
        };
        return (does(groups) || ...);
      },
      parts.groups);
}

/// What sets the values of a new element of a table's type by its place; empty where no group has values_at.
template <class Table, class Parts>
std::function<void(Point<Parts::dim> const&, std::span<double>)> setter_by_place(
    Parts const& parts) {
  bool any = false;
  auto const for_each_group = [](Parts const& of, auto const& visit) {
    [&]<int... G>(std::integer_sequence<int, G...>) {
      (visit(std::get<Group<typename Table::template formulation<G>>>(of.groups)), ...);
    }(std::make_integer_sequence<int, Table::groups>());
  };
  for_each_group(parts, [&]<class F>(Group<F> const& group) {
    if constexpr (element_values<F> > 0) any = any || group.values_at;
  });
  if (!any) return {};
  return [&parts, for_each_group](Point<Parts::dim> const& place, std::span<double> values) {
    std::size_t first = 0;
    for_each_group(parts, [&]<class F>(Group<F> const& group) {
      if constexpr (element_values<F> > 0)
        if (group.values_at)
          std::ranges::copy(
              values_of_place<typename Parts::T>(group, group.law_for(parts.material), place),
              values.begin() + static_cast<std::ptrdiff_t>(first));
      first += element_values<F>;
    });
  };
}

/// Of all element types of a body.
template <class Parts>
ElementValues<Parts::dim> element_values_of(Parts const& parts) {
  ElementValues<Parts::dim> values;
  parts.for_each_type([&](auto const& to, auto const&) {
    using To = std::remove_cvref_t<decltype(to)>;
    values.widths.push_back(To::Laws::value_count);
    auto& setter = values.set_by_place.emplace_back();
    if constexpr (To::Laws::value_count > 0) setter = setter_by_place<To>(parts);
    auto& places = values.places.emplace_back();
    parts.for_each_type([&](auto const& from, auto const&) {
      using From = std::remove_cvref_t<decltype(from)>;
      auto& own = places.emplace_back();
      if constexpr (are_convertible<From, To>) own = places_of_values<From, To>();
    });
  });
  return values;
}

}  // namespace pliant::detail
