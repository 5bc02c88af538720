#pragma once

#include <pliant/backend/sums.hpp>
#include <pliant/body/internal_variables.hpp>
#include <pliant/body/loads.hpp>

// Velocities that are a half-kick behind the time of a state.
namespace pliant {

/// The half-kicks of an advance: see HalfKick.
template <class Parts>
HalfKick<typename Parts::T> half_kick(Parts const& parts, double time) {
  return HalfKick<typename Parts::T>::over(time, parts.state.damping);
}

/// Whether added force terms pull: they may pull at nodes that sleep, without a part of their patches in it.
template <class Parts>
bool has_added_terms(Parts const& parts) {
  return !parts.pressures.empty() || !parts.terms.empty();
}

namespace detail {

/// Whether loops pass over nodes around which all sleeps. Nodes may belong to several patches, of several types: each
/// has one byte (AwakeSet::nodes) that tells. Those beside what is awake stand together, in runs of which there is a list.
template <class Parts>
bool passes_over_sleepers(Parts const& parts) {
  return parts.awake && !has_added_terms(parts) && !parts.forces_complete;
}
/// The sum of f(i) over the nodes, or those that may move: in the order of all, whichever sleep.
template <class Parts, class F>
void add_sum_over_moving_nodes(Parts const& parts, F const& f, double* to) {
  if (passes_over_sleepers(parts))
    parts.backend.add_sum(parts.layout.rows, AtAwakeNodes<F>{parts.awake->nodes.data(), f}, to);
  else
    parts.backend.add_sum(parts.layout.rows, f, to);
}
/// f(i) for all nodes, or for those that may move.
template <class Parts, class F>
void for_each_moving_node(Parts const& parts, F const& f) {
  Index const nodes = parts.layout.rows;
  if (!passes_over_sleepers(parts)) return parts.backend.for_each(nodes, f);
  auto const& runs = parts.patch_nodes->awake_runs;
  parts.backend.for_each((static_cast<Index>(runs.size()) - 1) * nodes_of_run,
                         InAwakeRuns<F>{runs.data(), {parts.awake->nodes.data(), f}, nodes});
}

/// Whether some terms have no energy; makes room for their forces, which a recorded step cannot.
template <class Parts>
bool reserve_terms_without_energy(Parts& parts) {
  bool any = false;
  for_each_added_term(parts, [&](auto const& term) { any = any || !term.has_energy(); });
  if (any && parts.without_energy.size() != parts.layout.f.size())
    parts.without_energy = zeros<typename Parts::T>(parts.backend, parts.layout.f.size());
  return any;
}

/// Brings parts.without_energy up to date: the forces of the terms that have no energy, and so do work that the
/// energies do not tell.
template <class Parts>
bool evaluate_terms_without_energy(Parts& parts) {
  if (!reserve_terms_without_energy(parts)) return false;
  typename Parts::Field const f{parts.without_energy.data()};
  clear_rows(parts, f);
  for_each_added_term(parts, [&](auto const& term) {
    if (!term.has_energy()) term.add_force(parts.backend, std::as_const(parts).here(), f);
  });
  parts.layout.interpolation.apply_transpose(parts.backend, f);
  return true;
}

/// Adds what damping and driven nodes do around the present time to state.work; before an Advance.
template <class Parts>
void book_work(Parts& parts, double lag, double kick, bool drifts) {
  using T = typename Parts::T;
  constexpr int dim = Parts::dim;
  auto const& layout = parts.layout;
  auto const external = external_forces(parts);
  double* const work = parts.state.work.data();
  typename Parts::ConstField const v{parts.state.v.data()}, f{layout.f.data()};
  // One sum for each half-kick: reading the velocities between them changes no bit of the sums.
  for (bool first : {true, false}) {
    if ((first ? lag : kick) == 0) continue;
    if (parts.state.damping > 0)
      add_sum_over_moving_nodes(
          parts,
          DampingWork<T, dim>{v, f, layout.mass.data(), parts.still(), external,
                              half_kick(parts, lag), half_kick(parts, kick), first ? lag : kick,
                              first},
          work + static_cast<int>(Work::damping));
    for (auto const& driven : parts.driven)
      driven.add_work(parts.backend, v, f, layout.mass.data(), external.gravity, external.load,
                      first ? lag : 0, first ? 0 : kick, drifts && !first,
                      work + static_cast<int>(Work::motions));
  }
}

}  // namespace detail

namespace detail {
/// An advance under forces as `forces` reads them; follow_masters() brings slaves behind their masters.
template <class Parts, class Forces, class FollowMasters>
void advance_under(Parts& parts, double lag, double kick, double drift, Forces const& forces,
                   FollowMasters const& follow_masters) {
  using T = typename Parts::T;
  constexpr int dim = Parts::dim;
  auto const& layout = parts.layout;
  bool const hidden_work = evaluate_terms_without_energy(parts);
  auto const book_hidden = [&](double time) {
    if (hidden_work && time > 0)
      parts.backend.add_sum(
          layout.rows,
          WorkRate<T, dim>{{parts.without_energy.data()}, std::as_const(parts).v(), time},
          parts.state.work.data() + static_cast<int>(Work::pressures));
  };
  book_hidden(lag);
  for_each_moving_node(
      parts, Advance<T, dim, Forces>{parts.u(), parts.v(), forces, layout.mass.data(),
                                     parts.still(), external_forces(parts), half_kick(parts, lag),
                                     half_kick(parts, kick), static_cast<T>(drift)});
  follow_masters();
  if (drift != 0) parts.forces_current = parts.forces_complete = false;
  book_hidden(kick);
}
}  // namespace detail

/// Velocities and displacements go forward: see Advance. Times in s. The forces are those of the present
/// displacements, and motions were asked for the end of the step where there is one.
template <class Parts>
void advance(Parts& parts, double lag, double kick, double drift) {
  detail::book_work(parts, lag, kick, drift != 0);
  detail::advance_under(parts, lag, kick, drift, parts.f(), [&] {
    auto const& interpolation = parts.layout.interpolation;
    if (drift != 0)
      interpolation.apply(parts.backend, parts.u(), parts.v());
    else
      interpolation.apply(parts.backend, parts.v());
  });
}

/// Whether advance_handing_on may be asked: where there are slaves, and forces are read nowhere else in a step.
template <class Parts>
bool can_hand_on_in_advance(Parts const& parts) {
  return !parts.layout.interpolation.empty() && parts.state.damping == 0 && parts.driven.empty();
}
/// Before a loop over nodes that hands forces on is recorded.
template <class Parts>
void prepare_handing_on(Parts& parts) {
  if (can_hand_on_in_advance(parts))
    parts.layout.interpolation.list_by_node(parts.backend, parts.layout.rows);
}
/// An advance, with a drift, under forces of which slaves still hold theirs.
template <class Parts>
void advance_handing_on(Parts& parts, double lag, double kick, double drift) {
  auto const& interpolation = parts.layout.interpolation;
  detail::advance_under(parts, lag, kick, drift, interpolation.handed_on(parts.f()), [&] {
    interpolation.apply_and_clear(parts.backend, parts.u(), parts.v(), parts.f());
  });
}

/// Gives velocities the half-kick that the last step left pending, so that they belong to state.time.
template <class Parts>
void synchronize_velocities(Parts& parts) {
  if (parts.state.pending_half_kick == 0) return;
  evaluate_forces(parts);
  advance(parts, parts.state.pending_half_kick, 0, 0);
  parts.state.pending_half_kick = 0;
}

namespace detail {
template <class Parts>
KineticEnergy<typename Parts::T, Parts::dim> kinetic_energy_of_nodes(Parts& parts) {
  synchronize_velocities(parts);
  return {std::as_const(parts).v(), parts.layout.mass.data()};
}
}  // namespace detail

/// Σ m v²/2, J.
template <class Parts>
double kinetic_energy_of(Parts& parts) {
  return parts.backend.sum(parts.layout.rows, detail::kinetic_energy_of_nodes(parts));
}
/// Adds that to *to in the backend's memory.
template <class Parts>
void add_kinetic_energy(Parts& parts, double* to) {
  parts.backend.add_sum(parts.layout.rows, detail::kinetic_energy_of_nodes(parts), to);
}

/// Adds strain, kinetic and potential energy to to[3] in the backend's memory.
template <class Parts>
void add_energies(Parts& parts, double* to) {
  add_energy_at(std::as_const(parts), std::as_const(parts).u(), to);
  add_kinetic_energy(parts, to + 1);
  add_potential_energy(parts, to + 2);
}
template <class Parts>
Energies energies_of(Parts& parts) {
  Sums<3, typename Parts::backend_type> sums(parts.backend);
  add_energies(parts, sums.data());
  auto const [strain, kinetic, potential] = sums.read();
  return {strain, kinetic, potential};
}
/// The present energies, where add_term(parts, to) is a Parts::add_watched_term.
template <class Parts, class AddTerm>
WatchedEnergy watched_energy_of(Parts& parts, AddTerm const& add_term) {
  Sums<4, typename Parts::backend_type> sums(parts.backend);
  add_energies(parts, sums.data());
  add_term(parts, sums.data() + 3);
  auto const [strain, kinetic, potential, term] = sums.read();
  return {{strain, kinetic, potential}, square(parts.state.integrator.step) * term};
}
/// Strain, kinetic and potential energy, J.
template <class Parts>
double total_energy_of(Parts& parts) {
  return energies_of(parts).total();
}

}  // namespace pliant
