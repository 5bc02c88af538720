#pragma once

#include <vector>

#include <pliant/body/parts.hpp>
#include <pliant/force/forces.hpp>

namespace pliant::detail {

/// The energy of some elements, and of force terms that have one, J. `elements`, `groups`: per type, by the user's numbers,
/// and the groups of all; rows_of.operator()<E>(): the nodes of those of one type, by the user's numbers. Where laws read what
/// is kept per element, that of all elements of the type.
template <class Parts, class RowsOf>
double energy_of_some(Parts const& parts, std::vector<std::vector<Index> const*> const& elements,
                      RowsOf const& rows_of, std::vector<std::vector<Tag>> const& groups) {
  double sum = 0;
  std::size_t type = 0;
  parts.for_each_type([&](auto const& table, auto const&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    using E = typename Table::element;
    auto const& list = *elements[type];
    auto const& tags = groups[type++];
    auto const add = [&](auto const& table_of_them) {
      table.with_geometry([&](auto geometry) {
        sum += parts.backend.template sum_elements<Table::groups>(
            table_of_them, EnergyKernel<typename Table::Laws, geometry.value>{table.laws},
            parts.rest(), parts.u());
      });
    };
    if constexpr (Table::Laws::reads_elements) {
      add(table.elements);
    } else if (!list.empty()) {
      std::vector<Connectivity<E>> nodes = rows_of.template operator()<E>();
      std::vector<Tag> own;
      for (auto& row : nodes)
        for (Index& node : row) node = parts.layout.internal_of(node);
      for (Index const e : list) own.push_back(tags[static_cast<std::size_t>(e)]);
      add(typename Parts::backend_type::template Elements<E::nodes>(
          parts.backend, std::move(nodes), Table::groups, own, parts.layout.rows));
    }
  });
  for_each_added_term(parts, [&](auto const& term) {
    if (term.has_energy()) sum += term.energy(parts.backend, parts.at(parts.u()));
  });
  return sum;
}

}  // namespace pliant::detail
