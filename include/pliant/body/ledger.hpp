#pragma once

#include <pliant/body/body.hpp>

// What a user can read of a body's adaptation.
namespace pliant {

namespace detail {

/// The counters of one element type: of the layouts that are gone and of the present one.
template <class TheBody, class Table>
std::vector<double> counters(TheBody const& body, Table const& table, std::size_t which) {
  std::vector<double> sums(CounterLayout<Table::groups>::count, 0.0);
  if (which < body.history().totals.size()) sums = body.history().totals[which].counters;
  if (table.statistics.open) {
    auto const own = download<double>(table.statistics.counters);
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += own[k];
  }
  return sums;
}

/// The same with the elements' present stay in their groups.
template <class TheBody, class Table>
std::vector<double> all_counters(TheBody const& body, Table const& table, std::size_t which) {
  using Counters = CounterLayout<Table::groups>;
  std::vector<double> sums = counters(body, table, which);
  auto const tags = download<Tag>(table.elements.tags());
  std::vector<Index> since(tags.size(), static_cast<Index>(body.history().born));
  if (table.statistics.open) since = download<Index>(table.statistics.since);
  for (std::size_t e = 0; e < tags.size(); ++e)
    if (tags[e] < Table::groups)
      sums[static_cast<std::size_t>(Counters::steps_of(tags[e]))] +=
          static_cast<double>(body.steps() - since[e]);
  return sums;
}

template <class TheBody, class E, std::size_t I = 0>
constexpr std::size_t table_index() {
  using Tables = decltype(std::declval<typename TheBody::layout_type&>().tables);
  if constexpr (std::same_as<typename std::tuple_element_t<I, Tables>::element, E>)
    return I;
  else
    return table_index<TheBody, E, I + 1>();
}

/// Adds the statistics of the present layout to the history, before the layout goes.
template <class TheBody>
auto closed_totals(TheBody const& body) {
  std::vector<typename std::remove_cvref_t<decltype(body.history())>::Totals> totals;
  body.for_each_table(
      [&](auto const& table) { totals.push_back({all_counters(body, table, totals.size())}); });
  return totals;
}

}  // namespace detail

/// How many steps elements of a type have spent in each of its groups, summed over elements.
template <Element E, class TheBody>
std::vector<double> element_steps(TheBody const& body) {
  auto const& table = body.layout().template table<E>();
  auto sums = detail::all_counters(body, table, detail::table_index<TheBody, E>());
  sums.resize(static_cast<std::size_t>(table.groups));
  return sums;
}

/// How often each element changed its group, by the user's number; from zero again for all elements
/// after a refinement.
template <Element E, class TheBody>
std::vector<int> switch_counts(TheBody const& body) {
  auto const& table = body.layout().template table<E>();
  std::vector<int> counts(static_cast<std::size_t>(table.count()), 0);
  if (table.statistics.open) {
    auto const internal = download<std::uint16_t>(table.statistics.switches);
    for (std::size_t e = 0; e < internal.size(); ++e)
      counts[static_cast<std::size_t>(table.user_element[e])] = internal[e];
  }
  return counts;
}

/// What switching and refining have added to the strain and kinetic energy so far, J.
template <class TheBody>
double adaptation_energy(TheBody const& body) {
  double sum = 0;
  for (auto const& entry : body.history().refinements)
    sum += entry.strain_energy + entry.kinetic_energy;
  std::size_t which = 0;
  body.for_each_table([&](auto const& table) {
    using Counters = CounterLayout<std::remove_cvref_t<decltype(table)>::groups>;
    auto const sums = detail::counters(body, table, which++);
    for (std::size_t k = Counters::energy(0, 0); k < sums.size(); ++k) sum += sums[k];
  });
  return sum;
}

/// Every change of energy that adaptation made: one entry per pair of groups that elements moved
/// between, summed over time, and one per refinement.
template <class TheBody>
auto ledger(TheBody const& body) {
  auto entries = body.history().refinements;
  std::size_t which = 0;
  body.for_each_table([&](auto const& table) {
    using Table = std::remove_cvref_t<decltype(table)>;
    using Counters = CounterLayout<Table::groups>;
    auto const sums = detail::counters(body, table, which++);
    for (int from = 0; from < Table::groups; ++from)
      for (int to = 0; to < Table::groups; ++to) {
        double const moved = sums[static_cast<std::size_t>(Counters::moves(from, to))];
        if (moved > 0)
          entries.push_back(
              {body.time(),
               detail::message({Table::element::name(), " group ", from, " to group ", to}),
               moved,
               sums[static_cast<std::size_t>(Counters::energy(from, to))],
               sums[static_cast<std::size_t>(Counters::kinetic(from, to))],
               {}});
      }
  });
  return entries;
}

}  // namespace pliant
