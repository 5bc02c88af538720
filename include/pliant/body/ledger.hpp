#pragma once

#include <span>

#include <pliant/body/parts.hpp>

// What a user can read of a body's adaptation.
namespace pliant {

namespace detail {

/// The counters of one element type: of the meshes that are gone and of the present one.
template <class Table, class Parts, class Elements>
std::vector<double> counters(Parts const& parts, Elements const& elements, std::size_t which) {
  std::vector<double> sums(CounterLayout<Table::groups>::count, 0.0);
  auto const& totals = parts.state.record.totals;
  if (which < totals.size()) sums = totals[which];
  if (elements.statistics.open) {
    auto const own = download<double>(elements.statistics.counters);
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += own[k];
  }
  return sums;
}

/// How many steps an element has been in a group, where that is the present one. `since`: by element; null: all came at
/// step `born`.
struct StepsInGroup {
  Tag const* tags;
  std::int64_t const* since;
  std::int64_t born, now;
  Tag group;
  PLIANT_HOST_DEVICE double operator()(Index e) const {
    if (tags[e] != group) return 0;
    return static_cast<double>(now - (since == nullptr ? born : since[e]));
  }
};

/// The same with the elements' present stay in their groups.
template <class Table, class Parts, class Elements>
std::vector<double> all_counters(Parts const& parts, Elements const& elements, std::size_t which) {
  std::vector<double> sums = counters<Table>(parts, elements, which);
  auto const& statistics = elements.statistics;
  std::int64_t const born = parts.state.record.born, now = parts.state.steps;
  if (!statistics.open && born == now) return sums;
  for (int group = 0; group < Table::groups; ++group)
    sums[static_cast<std::size_t>(CounterLayout<Table::groups>::steps_of(group))] +=
        parts.backend.sum(
            static_cast<Index>(elements.tags.size()),
            StepsInGroup{elements.tags.data(), statistics.open ? statistics.since.data() : nullptr,
                         born, now, static_cast<Tag>(group)});
  return sums;
}

/// Calls visit(table, element state, number of the type) for each element type.
template <class Parts, class Visit>
void for_each_numbered_type(Parts const& parts, Visit const& visit) {
  std::size_t which = 0;
  parts.for_each_type(
      [&](auto const& table, auto const& elements) { visit(table, elements, which++); });
}

/// The counters of all types, with the present stays: what is kept of a mesh before it goes.
template <class Parts>
std::vector<std::vector<double>> closed_totals(Parts const& parts) {
  std::vector<std::vector<double>> totals;
  for_each_numbered_type(parts, [&](auto const& table, auto const& elements, std::size_t which) {
    totals.push_back(all_counters<std::remove_cvref_t<decltype(table)>>(parts, elements, which));
  });
  return totals;
}

}  // namespace detail

/// How many steps elements of a type have spent in each of its groups, summed over elements.
template <Element E, DeformableBody TheBody>
std::vector<double> element_steps(TheBody const& body) {
  static_assert(TheBody::layout_type::template has<E>,
                "element_steps<E>: the body's mesh does not have this element type");
  std::vector<double> sums;
  detail::for_each_numbered_type(
      body.parts(), [&](auto const& table, auto const& elements, std::size_t which) {
        using Table = std::remove_cvref_t<decltype(table)>;
        if constexpr (std::same_as<typename Table::element, E>) {
          sums = detail::all_counters<Table>(body.parts(), elements, which);
          sums.resize(static_cast<std::size_t>(Table::groups));
        }
      });
  return sums;
}

/// How often each element changed its group, by the user's number; from zero again for all elements
/// after a refinement. Counts stay at the largest `int` once there.
template <Element E, DeformableBody TheBody>
std::vector<int> switch_counts(TheBody const& body) {
  static_assert(TheBody::layout_type::template has<E>,
                "switch_counts<E>: the body's mesh does not have this element type");
  std::vector<int> counts;
  body.parts().for_each_type([&](auto const& table, auto const& elements) {
    if constexpr (std::same_as<typename std::remove_cvref_t<decltype(table)>::element, E>) {
      counts.resize(static_cast<std::size_t>(table.count()), 0);
      if (!elements.statistics.open) return;
      auto const internal = download<std::int32_t>(elements.statistics.switches);
      auto const& user = table.user_elements();
      for (std::size_t e = 0; e < internal.size(); ++e)
        counts[static_cast<std::size_t>(user[e])] = internal[e];
    }
  });
  return counts;
}

namespace detail {

/// What changes of a body's energy are booked, J, and how many are not because they are not finite. An integrator that finds
/// more of these than before has nothing to compare energies with.
struct Booked {
  double energy, not_finite;
};

/// What switching, refining and sleep have added to the strain and kinetic energy so far. `work`: what is in state.work.
template <class Parts>
Booked booked_by_adaptation(Parts const& parts, std::span<double const> work) {
  auto const at = [&](Work which) { return work[static_cast<std::size_t>(which)]; };
  Booked booked{at(Work::switching) + at(Work::sleep) + parts.state.record.refinements.energy(),
                at(Work::unbooked)};
  for_each_numbered_type(parts, [&](auto const& table, auto const& elements, std::size_t which) {
    using Table = std::remove_cvref_t<decltype(table)>;
    using Counters = CounterLayout<Table::groups>;
    auto const sums = counters<Table>(parts, elements, which);
    for (std::size_t k = Counters::energy(0, 0); k < std::size_t{Counters::unbooked}; ++k)
      booked.energy += sums[k];
    booked.not_finite += sums[std::size_t{Counters::unbooked}];
  });
  return booked;
}

}  // namespace detail

/// What switching, refining and sleep have added to the strain and kinetic energy so far, J.
template <class Parts>
double adaptation_energy_of(Parts const& parts) {
  return detail::booked_by_adaptation(parts, download<double>(parts.state.work)).energy;
}
/// The same, of a body.
template <DeformableBody TheBody>
double adaptation_energy(TheBody const& body) {
  return adaptation_energy_of(body.parts());
}

/// What has changed a body's total energy besides time integration and adaptation, J.
struct ExternalWork {
  double changed_loads;  // loads and gravity are in the potential energy; changes of them are here
  double damping;        // negative
  double motions;        // of driven nodes
  double pressures;      // and of other force terms that have no energy
  double by_hand;        // displacements, velocities, groups, conditions that a user set since an
                         // integrator took the body
  double steps;  // changes of the time step and of levels, on which leapfrog's energy depends
  double sum() const { return changed_loads + damping + motions + pressures + by_hand + steps; }
};

/// The work on a body since it was made: of loads from the first on, by hand once an integrator has taken the
/// body, and the rest where integrators step. `work`: what is in state.work.
template <class Parts>
ExternalWork external_work_of(Parts const& parts, std::span<double const> work) {
  auto const at = [&](Work which) { return work[static_cast<std::size_t>(which)]; };
  return {at(Work::changed_loads), at(Work::damping),          at(Work::motions),
          at(Work::pressures),     parts.state.energy_by_hand, parts.state.energy_of_steps};
}
/// The same, of a body.
template <DeformableBody TheBody>
ExternalWork external_work(TheBody const& body) {
  auto const& parts = body.parts();
  return external_work_of(parts, download<double>(parts.state.work));
}

namespace detail {
/// All that is booked: what a body's energy has changed by besides time integration. `work`: what is in state.work.
template <class Parts>
Booked booked(Parts const& parts, std::span<double const> work) {
  auto all = booked_by_adaptation(parts, work);
  all.energy += external_work_of(parts, work).sum();
  return all;
}
}  // namespace detail

/// That, J.
template <class Parts>
double booked_energy(Parts const& parts) {
  return detail::booked(parts, download<double>(parts.state.work)).energy;
}

/// Every change of energy that adaptation made: one entry per pair of groups that elements moved
/// between, summed over time, one of what elements that moved together added beyond that, one of what
/// falling asleep took and waking gave, and one per refinement. A refinement has the time at which it was
/// made; sums over time have the body's present time.
template <DeformableBody TheBody>
auto ledger(TheBody const& body) {
  auto const& refinements = body.state().record.refinements;
  std::vector<LedgerEntry<TheBody::dim>> entries(refinements.begin(), refinements.end());
  detail::for_each_numbered_type(
      body.parts(), [&](auto const& table, auto const& elements, std::size_t which) {
        using Table = std::remove_cvref_t<decltype(table)>;
        using Counters = CounterLayout<Table::groups>;
        auto const sums = detail::counters<Table>(body.parts(), elements, which);
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
  auto const work = download<double>(body.state().work);
  double const together = work[static_cast<std::size_t>(Work::switching)];
  double const sleep = work[static_cast<std::size_t>(Work::sleep)];
  if (together != 0) entries.push_back({body.time(), "groups together", 0, 0, together, {}});
  if (sleep != 0) entries.push_back({body.time(), "sleep", 0, 0, sleep, {}});
  return entries;
}

}  // namespace pliant
