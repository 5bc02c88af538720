#pragma once

#include <vector>

#include <pliant/body/parts.hpp>
#include <pliant/force/forces.hpp>

namespace pliant::detail {

/// The energy of some elements, and of force terms that have one, J. visit_elements.operator()<E>(visit): visit(number, nodes)
/// for those of one type, by the user's numbers. `groups`: of all elements, per type, by the user's numbers. Where laws
/// read what is kept per element, the energy of all elements of the type.
template <class Parts, class VisitElements>
double energy_of_some(Parts const& parts, VisitElements const& visit_elements,
                      std::vector<std::vector<Tag>> const& groups) {
  double sum = 0;
  std::size_t type = 0;
  parts.for_each_type([&](auto const& table, auto const&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    using E = typename Table::element;
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
    } else {
      std::vector<Connectivity<E>> nodes;
      std::vector<Tag> own;
      visit_elements.template operator()<E>([&](Index e, Connectivity<E> row) {
        for (Index& node : row) node = parts.layout.internal_of(node);
        nodes.push_back(row);
        own.push_back(tags[static_cast<std::size_t>(e)]);
      });
      if (!own.empty())
        add(typename Parts::backend_type::template Elements<E::nodes>(
            parts.backend, std::move(nodes), Table::groups, own, parts.layout.rows));
    }
  });
  return sum + energy_of_added_terms(parts);
}

}  // namespace pliant::detail
