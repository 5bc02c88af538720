#pragma once

#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <pliant/body/internal_variables.hpp>
#include <pliant/constraint/conditions.hpp>

// The groups of a body's elements, by hand.
namespace pliant {

/// The group of each element of a type, by the user's number.
template <Element E, class Parts>
std::vector<Tag> user_groups(Parts const& parts) {
  static_assert(Parts::layout_type::template has<E>,
                "groups are asked for an element type that the body's mesh does not have");
  std::vector<Tag> tags;
  parts.for_each_type([&](auto const& table, auto const& elements) {
    if constexpr (std::same_as<typename std::remove_cvref_t<decltype(table)>::element, E>) {
      tags = table.tags_in_user_order(elements.tags);
    }
  });
  return tags;
}

/// Puts elements of a type into a group, by the users' numbers.
template <class F, class Parts>
void assign_group(Parts& parts, std::vector<Index> const& elements) {
  using E = typename F::element;
  static_assert(Parts::layout_type::template has<E>,
                "assign<F>: F is for an element type that the body's mesh does not have");
  parts.for_each_type([&](auto& table, auto& state) {
    using Table = std::remove_reference_t<decltype(table)>;
    if constexpr (std::same_as<typename Table::element, E>) {
      constexpr int group = Table::template group_of<F>;
      static_assert(group < Table::groups, "assign<F>: this body has no Group<F>");
      std::vector<Tag> user = user_groups<E>(parts);
      for (Index e : elements) {
        if (e < 0 || e >= table.count())
          throw Error("body.assign: there is no ", E::name(), " element ", e,
                      "; they are numbered 0 to ", table.count() - 1);
        user[static_cast<std::size_t>(e)] = static_cast<Tag>(group);
      }
      auto const internal = table.tags_in_internal_order(user);
      auto const old = download<Tag>(state.tags);
      if (internal == old) return;
      change_by_hand(parts, [&] {
        if (auto& statistics = state.statistics;
            statistics.open || parts.state.steps > parts.state.record.born) {
          if (!statistics.open)
            statistics.start(parts.backend, table.count(), parts.state.record.born);
          statistics.enter(old, internal, parts.state.steps);
        }
        auto const before = upload(parts.backend, old);
        state.tags.upload(internal);
        table.elements.regroup();
        if constexpr (Table::Laws::internal_variable_count > 0)
          parts.backend.template visit<Table::groups>(
              table.elements,
              CarryInternalVariables<typename Parts::T, typename Table::Laws>{table.laws,
                                                                              before.data()},
              parts.no_counters, parts.rest(), std::as_const(parts).u());
      });
    }
  });
}

namespace detail {

/// Values of an element that where() names. Throws Error where they are not finite in T, or impossible.
template <class T, class F, class Where>
void check_values(typename F::template law<double> const& law,
                  std::array<double, element_values<F>> const& values, Where const& where) {
  Vector<double, element_values<F>> row;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!std::isfinite(static_cast<T>(values[k])))
      throw Error(
          "body: value ", k, " of ", where(),
          std::isfinite(values[k]) ? " is too large for single precision" : " is not finite",
          "; mend the group's values");
    row[static_cast<int>(k)] = values[k];
  }
  check_law(law.at(row), [&] { return "of " + where(); });
}

/// The values of an element by its place.
template <class T, class F>
std::array<double, element_values<F>> values_of_place(Group<F> const& group,
                                                      typename F::template law<double> const& law,
                                                      Point<F::dim> const& place) {
  auto const values = group.values_at(place);
  check_values<T, F>(law, values, [&] {
    return message({"an element ", F::element::name(), " around ", place});
  });
  return values;
}

/// What laws read per element, for the elements of one type: (elements, values), by the user's number.
template <class T, Element E, class M, class... Fs>
std::vector<double> element_values_of(std::tuple<Group<Fs>...> const& groups,
                                      Elastic const& material, M const& mesh) {
  auto const& elements = mesh.template elements<E>();
  std::size_t const count = elements.size();
  std::vector<std::vector<double>> columns;  // by value
  auto const take = [&]<class F>(Group<F> const& group) {
    if constexpr (std::same_as<typename F::element, E> && element_values<F> > 0) {
      auto const law = group.law_for(material);
      auto values = group.values;
      if (group.values_at) {
        if (!values.empty())
          throw Error("body: a group on ", E::name(),
                      " has values and values_at; give one of them");
        for (auto const& element : elements)
          values.push_back(values_of_place<T>(group, law, mean_of_nodes(mesh, element)));
      }
      if (values.size() != count && values.size() != 1)
        throw Error("body: a group's law reads ", element_values<F>,
                    " values per element; give values for 1 or for all ", count, " ", E::name(),
                    " elements, not for ", values.size());
      for (std::size_t e = 0; e < values.size(); ++e)
        check_values<T, F>(law, values[e], [&] { return message({E::name(), " element ", e}); });
      for (std::size_t k = 0; k < element_values<F>; ++k) {
        columns.emplace_back(count);
        for (std::size_t e = 0; e < count; ++e)
          columns.back()[e] = values[values.size() == 1 ? 0 : e][k];
      }
    }
  };
  std::apply([&](auto const&... group) { (take(group), ...); }, groups);
  std::vector<double> values;
  for (std::size_t e = 0; e < count; ++e)
    for (auto const& column : columns) values.push_back(column[e]);
  return values;
}

}  // namespace detail
}  // namespace pliant
