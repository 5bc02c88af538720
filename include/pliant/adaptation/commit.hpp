#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pliant/adaptation/family_momentum.hpp>
#include <pliant/backend/sums.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/backend_change.hpp>
#include <pliant/body/change_topology.hpp>
#include <pliant/topology/plan.hpp>

// Changes of a body's mesh that are planned on the host, and how changes are put in force.
namespace pliant {

namespace detail {

/// What a body's conditions need where elements are merged.
template <class Parts>
KeptParts<Parts::dim> kept_parts(Parts const& parts) {
  KeptParts<Parts::dim> kept;
  auto const& prescribed = *parts.state.prescribed;
  for (auto const& condition : prescribed.conditions) {
    if (condition.facets.empty())
      kept.nodes.insert(kept.nodes.end(), condition.nodes.begin(), condition.nodes.end());
    else
      kept.facets.push_back(&condition.facets);
  }
  for (auto const& pressure : prescribed.pressures) kept.facets.push_back(&pressure.facets);
  return kept;
}

/// What a change does, in words.
template <class Counts>
std::string actions_of(Counts const& counts) {
  std::string words;
  auto const add = [&](std::size_t count, char const* word) {
    if (count > 0) words += (words.empty() ? "" : " and ") + std::string(word);
  };
  add(counts.refined, "refine");
  add(counts.coarsened, "coarsen");
  add(counts.raised, "raise");
  add(counts.lowered, "lower");
  add(counts.split, "split");
  add(counts.merged, "merge");
  return words;
}

/// How many elements a change acts on.
template <class M>
std::size_t count_actions(TopologyPlan<M> const& plan) {
  auto const& counts = plan.counts;
  return counts.refined + counts.coarsened + counts.raised + counts.lowered + counts.split +
         counts.merged;
}

}  // namespace detail

/// Plans a change of a body's mesh: see refine, coarsen, raise, lower, split and merge. Empty where nothing changes. Throws Error where an
/// element is unknown, the body's limits would be exceeded, or a listener of a change asks for it.
template <class Parts>
auto plan_change(Parts const& parts, MarkedElements const& marked, int max_level = 30) {
  detail::check_nobody_is_told(parts, "change of the mesh");
  HostThreads const threads(parts.backend, *parts.state.topology);
  return plan_change(parts.state.topology.shared(), marked,
                     {parts.limits.nodes, parts.limits.elements, max_level},
                     detail::kept_parts(parts), detail::element_values_of(parts));
}

namespace detail {

/// Puts a ChangedTopology, which change() gives, in force, and books what it does to energies. `actions`, `count`: in words, and
/// on how many elements it acts.
template <class Parts, class Change>
void commit_change(Parts& parts, std::string actions, std::size_t count, Change const& change) {
  constexpr int dim = Parts::dim;
  wake_all(parts);
  enum Sum : std::size_t { potential, term, all };  // before, and as many behind
  // Without a value where there is nothing to add up: reading sums waits for a backend.
  std::optional<Sums<2 * all, typename Parts::backend_type>> sums;
  if (parts.add_watched_term != nullptr) sums.emplace(parts.backend);
  auto const add = [&](Parts& p, std::size_t first) {
    if (!sums) return;
    double* const to = sums->data() + first;
    add_potential_energy(p, to + potential);
    p.add_watched_term(p, to + term);
  };
  add(parts, 0);
  auto changed = change();
  auto& next = changed.parts;
  add(next, all);
  if (changed.changed_rows.marks.size() > 0)  // waits, too
    parts.raise_bounds(parts, next, changed.changed_rows);
  auto const read = sums ? sums->read() : std::array<double, 2 * all>{};
  auto const energy_of = [](Parts const& p, ChangedEnergy const& own, double const* from) {
    return WatchedEnergy{{own.strain, own.kinetic, from[potential]},
                         square(p.state.integrator.step) * from[term]};
  };
  auto const before = energy_of(parts, changed.before, read.data());
  auto const after = energy_of(next, changed.after, read.data() + all);
  auto const added_to = [](double from, double to) { return zero_if_not_finite(to - from); };
  LedgerEntry<dim> const entry{next.state.time,
                               std::move(actions),
                               static_cast<double>(count),
                               added_to(before.energies.strain, after.energies.strain),
                               added_to(before.energies.kinetic, after.energies.kinetic),
                               changed.taken};
  next.state.record.refinements.push_back(entry);
  // The energy that an integrator keeps may have changed by more, with masses and forces.
  double const added = next.add_watched_term ? watched_change(next, before, after) : 0;
  if (next.add_watched_term && next.state.integrator.active)
    next.state.energy_by_hand += added - entry.strain_energy - entry.kinetic_energy;
  put_in_force(parts, std::move(next));
}

}  // namespace detail

/// Makes a planned change; listeners wait for tell_listeners. Throws Error, with the body as it was, where
/// fields are not finite, a force term cannot be made anew or memory runs out.
template <class Parts>
void commit(Parts& parts, TopologyPlan<typename Parts::mesh_type> const& plan) {
  HostThreads const threads(parts.backend, *plan.after);
  auto const give_back = [&](auto const& touched, auto const& layout, auto const& held,
                             auto v_before, auto& v) {
    return detail::give_momentum_back(plan, touched, parts.material.density, layout, held,
                                      std::move(v_before), v);
  };
  detail::commit_change(parts, detail::actions_of(plan.counts), detail::count_actions(plan), [&] {
    return change_topology(parts, plan.after, plan.transfer, give_back);
  });
  parts.host_changes.made();
}

/// What listeners are still to be told of a change that was made.
template <class M, Backend B>
struct ToTell {
  std::optional<TopologyPlan<M>> plan{};  // where the host has one
  std::optional<detail::ChangedOn<M, B>>
      there{};  // where the backend made it, and somebody listens
};

namespace detail {

/// Either may be null.
template <class Parts>
void tell(Parts& parts, TopologyPlan<typename Parts::mesh_type> const* plan,
          ChangedOn<typename Parts::mesh_type, typename Parts::backend_type> const* there) {
  struct Telling {
    bool& is_telling;
    explicit Telling(bool& flag) : is_telling(flag) { is_telling = true; }
    Telling(Telling const&) = delete;
    Telling& operator=(Telling const&) = delete;
    ~Telling() { is_telling = false; }
  } const telling(parts.is_telling);
  if (plan != nullptr)
    for (auto const& listener : parts.listeners)
      listener({*plan->before, *plan->after, plan->transfer});
  for (auto const& listener : parts.backend_listeners)
    if (there != nullptr)
      listener({parts.backend, *there});
    else if (plan != nullptr)
      listener({parts.backend, plan->transfer});
}

}  // namespace detail

/// Tells a body's listeners of a change that was made. What one throws is the caller's: the mesh is changed,
/// and listeners after it are not told.
template <class Parts>
void tell_listeners(Parts& parts, TopologyPlan<typename Parts::mesh_type> const& plan) {
  detail::tell(parts, &plan, nullptr);
}
template <class Parts>
void tell_listeners(
    Parts& parts, ToTell<typename Parts::mesh_type, typename Parts::backend_type> const& to_tell) {
  detail::tell(parts, to_tell.plan ? &*to_tell.plan : nullptr,
               to_tell.there ? &*to_tell.there : nullptr);
}

}  // namespace pliant
