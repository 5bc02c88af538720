#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pliant/adaptation/family_momentum.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/body/change_topology.hpp>
#include <pliant/body/changed_parts_on.hpp>
#include <pliant/topology/plan.hpp>

// Changes of a body's mesh: planned on the host and put in force, or made in the backend's memory.
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
template <class M>
std::string actions_of(TopologyPlan<M> const& plan) {
  std::string words;
  auto const add = [&](std::size_t count, char const* word) {
    if (count > 0) words += (words.empty() ? "" : " and ") + std::string(word);
  };
  auto const& counts = plan.counts;
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
/// element is unknown or the body's limits would be exceeded.
template <class Parts>
auto plan_change(Parts const& parts, MarkedElements const& marked, int max_level = 30) {
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
  auto const energies_but_strain = [](Parts& p) {
    return Energies{0, kinetic_energy_of(p), p.watched_energy ? potential_energy_of(p) : 0};
  };
  auto const energy_now = [](Parts& p, Energies const& energies) {
    return p.watched_energy ? p.watched_energy(p, energies) : WatchedEnergy{energies, 0};
  };
  auto energies = energies_but_strain(parts);
  auto changed = change();
  auto& next = changed.parts;
  energies.strain = changed.strain_energy_before;
  auto const before = energy_now(parts, energies);
  energies = energies_but_strain(next);
  energies.strain = changed.strain_energy;
  auto const after = energy_now(next, energies);
  auto const added_to = [](double from, double to) { return zero_if_not_finite(to - from); };
  LedgerEntry<dim> const entry{next.state.time,
                               std::move(actions),
                               static_cast<double>(count),
                               added_to(before.energies.strain, after.energies.strain),
                               added_to(before.energies.kinetic, after.energies.kinetic),
                               changed.taken};
  next.state.record.refinements.push_back(entry);
  // The energy that an integrator keeps may have changed by more, with masses and forces.
  double const added = next.watched_energy ? watched_change(next, before, after) : 0;
  if (next.watched_energy && next.state.integrator.active)
    next.state.energy_by_hand += added - entry.strain_energy - entry.kinetic_energy;
  put_in_force(parts, std::move(next));
}

/// What became of a change in a backend's memory.
struct ChangeOn {
  std::size_t refined = 0, new_nodes = 0, merged = 0, gone_nodes = 0;
};

/// Changes of a body's mesh in its backend's memory. What goes wrong late leaves the body as it was; what was kept of the mesh
/// there is made anew then when it is needed.
template <class Parts>
class ChangesOnBackend {
  using B = typename Parts::backend_type;
  using On = TopologyOn<typename Parts::mesh_type, B>;
  using Cells = typename B::template Array<Index>;

 public:
  ChangesOnBackend(Parts& parts, int max_level) : parts_(parts), max_level_(max_level) {}

  /// Nothing where the host has to do it.
  std::optional<ChangeOn> operator()(std::vector<Index> const& refine,
                                     std::vector<Index> const& coarsen) {
    ChangeOn done;
    if (!parts_.topology_on) {
      if (refine.empty() && !parts_.state.topology->tree) return done;  // there is nothing to merge
      parts_.topology_on = std::make_shared<On>(std::as_const(parts_));
    }
    if (!on().follow_conditions(std::as_const(parts_))) return std::nullopt;
    if (!coarsen.empty()) {
      if (!refine.empty()) return std::nullopt;
      auto const marked = cells_of(coarsen);
      auto const merged = on().tree.coarsen(marked.data(), size(coarsen));
      if (merged.merged > 0) {
        if (!on().held.coarsen(parts_.backend, on().tree, merged, on().rows.of_node())) {
          on().tree.take_back();
          return std::nullopt;
        }
        done.merged = static_cast<std::size_t>(merged.merged);
        done.gone_nodes = static_cast<std::size_t>(merged.before.nodes - merged.now.nodes);
        commit("coarsen", done.merged, [&](auto& changed) { return changed.coarsened(merged); });
      }
    }
    if (!refine.empty()) {
      auto const marked = cells_of(refine);
      auto const refined = on().tree.refine(
          marked.data(), size(refine), {parts_.limits.nodes, parts_.limits.elements, max_level_});
      if (refined.leaves > 0) {
        done.refined = static_cast<std::size_t>(refined.leaves);
        done.new_nodes = static_cast<std::size_t>(refined.new_nodes);
        commit("refine", done.refined, [&](auto& changed) { return changed.refined(refined); });
      }
    }
    return done;
  }

 private:
  static Index size(std::vector<Index> const& list) { return static_cast<Index>(list.size()); }
  On& on() { return *parts_.topology_on; }
  Cells cells_of(std::vector<Index> const& numbers) {
    auto cells = upload(parts_.backend, numbers);
    parts_.backend.for_each(size(numbers), CellsOfNumbers{on().numbers.cells(), cells.data()});
    return cells;
  }
  template <class Change>
  void commit(char const* action, std::size_t count, Change const& change) {
    auto const kept = std::exchange(parts_.topology_on, nullptr);  // gone where something throws
    commit_change(parts_, action, count, [&] {
      ChangedPartsOn<Parts> parts(parts_, *kept);
      auto changed = change(parts);
      kept->numbers.find(parts_.backend, kept->tree, kept->order);
      changed.parts.topology_on = kept;
      return changed;
    });
    kept->tree.keep();
  }

  Parts& parts_;
  int max_level_;
};

/// Changes a body's mesh in its backend's memory, where that can be; else nothing. Errors as of refine.
template <class Parts>
std::optional<ChangeOn> change_on_backend(Parts& parts, MarkedElements const& wanted,
                                          int max_level = 30) {
  if constexpr (changes_on_backend<Parts>) {
    auto others = wanted;
    auto const refine = std::exchange(others.refine, {});
    auto const coarsen = std::exchange(others.coarsen, {});
    if (!others.none() || !can_change_on_backend(parts)) return std::nullopt;
    auto const& table = std::get<0>(parts.layout.tables);
    using E = typename std::remove_cvref_t<decltype(table)>::element;
    auto const listed = [&](char const* verb, std::vector<std::vector<Index>> const& lists) {
      if (lists.empty()) return std::vector<Index>{};
      for (Index const e : lists[0])
        check_number<E>(verb, e, static_cast<std::size_t>(table.count()));
      return lists[0];
    };
    auto const to_refine = listed("refine", refine), to_coarsen = listed("coarsen", coarsen);
    if (to_refine.empty() && to_coarsen.empty()) return ChangeOn{};
    return ChangesOnBackend<Parts>(parts, max_level)(to_refine, to_coarsen);
  } else {
    return std::nullopt;
  }
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
  detail::commit_change(parts, detail::actions_of(plan), detail::count_actions(plan), [&] {
    return change_topology(parts, plan.after, plan.transfer, give_back);
  });
  parts.mesh_is_on_host = true;
}

/// Tells a body's listeners of a change that was made. What one throws is the caller's: the mesh is changed,
/// and listeners after it are not told.
template <class Parts>
void tell_listeners(Parts const& parts, TopologyPlan<typename Parts::mesh_type> const& plan) {
  for (auto const& listener : parts.listeners) listener({*plan.before, *plan.after, plan.transfer});
}

}  // namespace pliant
