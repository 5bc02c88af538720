#pragma once

#include <pliant/body/internal_variables.hpp>
#include <pliant/constraint/conditions.hpp>
#include <pliant/solver/impulse_kernels.hpp>

// Macro steps with local time steps, on the parts of a body. Within one, layout.f has impulses over the finest step
// in place of forces.
namespace pliant {

namespace detail {

/// Which half-kicks an event gives: of steps that end then, of steps that begin then.
struct Halves {
  bool ends, begins;
};

template <class Parts>
MovingNodes<typename Parts::T, Parts::dim> moving_nodes(Parts& parts, double macro_step) {
  auto const& schedule = *parts.schedule;
  return {schedule.nodes.data(),    schedule.rates.data(),
          parts.layout.mass.data(), parts.layout.held.data(),
          external_forces(parts),   {macro_step, schedule.finest, parts.state.damping}};
}

/// Calls visit(table, elements, laws, weight) for the patches whose level is at least `lowest`, with laws that see the step
/// of their level, of a macro step of `elapsed` s; 0: no time has passed. The weight of an element is the number of finest
/// steps in its own.
template <class Parts, class Visit>
void for_each_level(Parts& parts, int lowest, double elapsed, Visit const& visit) {
  using T = typename Parts::T;
  auto const& schedule = *parts.schedule;
  std::size_t type = 0;
  parts.for_each_type([&](auto& table, auto&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    auto const& lists = schedule.patches[type];
    auto const& weights = schedule.weights[type++];
    for (int level = lowest; level <= schedule.finest; ++level) {
      auto const& list = lists[static_cast<std::size_t>(level)];
      if (list.size() < 2) continue;  // no patch
      auto const elements = over(table.elements, list);
      SameWeight<T> const weight{static_cast<T>(std::ldexp(1.0, schedule.finest - level))};
      if constexpr (takes_levels_at_once<typename Parts::backend_type, Table>) {
        visit(table, elements, table.laws, OwnWeight<T>{{weights.data(), table.count()}});
        break;  // the list has the higher ones too
      } else if constexpr (Table::Laws::internal_variable_count > 0) {
        visit(table, elements, laws_over(parts, table, std::ldexp(elapsed, -level)), weight);
      } else {
        visit(table, elements, table.laws, weight);
      }
    }
  });
}

/// Adds the impulses of the elements and terms whose level is at least `lowest`, over the finest step. `elapsed`: see
/// for_each_level.
template <class Parts>
void accumulate_impulses(Parts& parts, int lowest, double elapsed = 0) {
  using T = typename Parts::T;
  auto const& schedule = *parts.schedule;
  auto const& backend = parts.backend;
  auto const at = std::as_const(parts).here();
  if (lowest <= schedule.term_level && !(parts.pressures.empty() && parts.terms.empty())) {
    for_each_added_term(parts, [&](auto const& term) { term.add_force(backend, at, parts.f()); });
    if (schedule.term_level < schedule.finest)
      backend.for_each(
          schedule.node_counts[static_cast<std::size_t>(schedule.term_level)],
          ScaleRows<T>{parts.layout.f.data(), schedule.nodes.data(),
                       static_cast<T>(std::ldexp(1.0, schedule.finest - schedule.term_level))});
  }
  for_each_level(parts, lowest, elapsed,
                 [&](auto& table, auto const& elements, auto const& laws, auto const& weight) {
                   using Table = std::remove_cvref_t<decltype(table)>;
                   using Weight = std::remove_cvref_t<decltype(weight)>;
                   table.with_geometry([&](auto geometry) {
                     backend.template accumulate<Table::groups>(
                         elements,
                         ImpulseKernel<typename Table::Laws, geometry.value, Weight>{laws, weight},
                         parts.f(), at.rest, at.u);
                   });
                 });
  parts.layout.interpolation.add_transpose(backend, parts.f());
}

/// One moment of a macro step at which nothing below a level acts: impulses, the nodes that take them, and internal
/// variables, which come to the present displacements. Where no step ends, no time has passed since they did.
template <class Parts>
void act(Parts& parts, double macro_step, int lowest, Halves halves) {
  using T = typename Parts::T;
  constexpr int dim = Parts::dim;
  auto const& backend = parts.backend;
  auto const& schedule = *parts.schedule;
  Index const count = schedule.node_counts[static_cast<std::size_t>(lowest)];
  double const elapsed = halves.ends ? macro_step : 0;
  accumulate_impulses(parts, lowest, elapsed);
  if constexpr (Parts::has_internal_variables)
    for_each_level(parts, lowest, elapsed,
                   [&](auto&, auto const& elements, auto const& laws, auto const&) {
                     commit_by(parts, elements, laws, std::as_const(parts).u());
                   });
  auto const nodes = moving_nodes(parts, macro_step);
  typename Parts::ConstField const v = std::as_const(parts).v(), impulses{parts.layout.f.data()};
  double* const work = parts.state.work.data();
  if (parts.state.damping > 0)
    backend.add_sum(count,
                    ImpulseDampingWork<T, dim>{nodes, v, impulses, halves.ends, halves.begins},
                    work + static_cast<int>(Work::damping));
  double const half = std::ldexp(macro_step, -schedule.finest) / 2;
  for (auto const& driven : parts.driven)
    driven.add_work(backend, v, impulses, parts.layout.mass.data(), nodes.external.gravity,
                    nodes.external.load, halves.ends ? half : 0, halves.begins ? half : 0,
                    halves.begins, work + static_cast<int>(Work::motions));
  bool const hidden = lowest <= schedule.term_level && evaluate_terms_without_energy(parts);
  auto const book_hidden = [&](bool acts) {
    if (hidden && acts)
      backend.add_sum(
          parts.layout.rows,
          WorkRate<T, dim>{
              {parts.without_energy.data()}, v, std::ldexp(macro_step, -schedule.term_level) / 2},
          work + static_cast<int>(Work::pressures));
  };
  book_hidden(halves.ends);
  backend.for_each(count, AdvanceByImpulses<T, dim>{nodes, parts.u(), parts.v(), parts.f(),
                                                    halves.ends, halves.begins});
  book_hidden(halves.begins);
  if (halves.begins) parts.layout.interpolation.apply(backend, parts.u());
}

/// The lowest level that acts at finest step j of a macro step.
inline int lowest_level(std::int64_t j, int finest) {
  int level = finest;
  while (level > 0 && j % (std::int64_t{2} << (finest - level)) == 0) --level;
  return level;
}

}  // namespace detail

/// Σ m Δv²/2, J, where Δv are the half-kicks around the end of a macro step, each over its own step: what the
/// total energy has over that of the steps around. Forces are left cleared.
template <class Parts>
double half_kick_energy(Parts& parts, double macro_step) {
  using T = typename Parts::T;
  forget_forces(parts);
  detail::accumulate_impulses(parts, 0);
  double const sum = parts.backend.sum(
      parts.layout.rows, detail::HalfKickEnergy<T, Parts::dim>{
                             detail::moving_nodes(parts, macro_step), {parts.layout.f.data()}});
  clear_rows(parts, parts.f());
  return sum;
}

/// Takes macro steps of a constant size, s, with a schedule; velocities belong to the displacements before and
/// after. Throws Error where a motion is not finite, at the end of the last macro step before that.
template <class Parts>
void take_macro_steps(Parts& parts, double macro_step, int steps) {
  using detail::act;
  auto& state = parts.state;
  auto& schedule = *parts.schedule;
  int const finest = schedule.finest;
  std::int64_t const events = std::int64_t{1} << finest;
  double const fine = std::ldexp(macro_step, -finest);
  forget_forces(parts);
  // What allocates or hands loads on to masters is no part of a step.
  (void)external_forces(parts);
  (void)detail::reserve_terms_without_energy(parts);
  auto const inside = [&parts, macro_step, finest, events] {
    for (std::int64_t j = 1; j < events; ++j)
      act(parts, macro_step, detail::lowest_level(j, finest), {true, true});
  };
  bool const follows = !parts.driven.empty();
  auto& recorded = schedule.recorded;
  if (!follows && finest > 0 &&
      (!recorded || recorded->step != macro_step || recorded->revision != parts.revision))
    recorded = {parts.backend.record(inside), macro_step, parts.revision};

  bool moving = false;  // a macro step has begun: kicks of the next one go with those of its end
  auto const end = [&] {
    if (moving) act(parts, macro_step, 0, {true, false});
    moving = false;
    parts.layout.interpolation.apply(parts.backend, parts.v());
  };
  for (; steps > 0; --steps) {
    double const begun = state.time;
    if (follows) {
      try {  // all that this macro step will ask
        for (std::int64_t j = 1; j <= events; ++j)
          ask_motions(parts, begun + static_cast<double>(j) * fine, fine);
        ask_motions(parts, begun + fine, fine);
      } catch (...) {
        end();
        throw;
      }
    }
    act(parts, macro_step, 0, {moving, true});
    moving = true;
    if (follows) {
      place_driven_nodes(parts);
      for (std::int64_t j = 1; j < events; ++j) {
        ask_motions(parts, begun + static_cast<double>(j + 1) * fine, fine);
        act(parts, macro_step, detail::lowest_level(j, finest), {true, true});
        place_driven_nodes(parts);
      }
    } else if (finest > 0) {
      recorded->recording.replay(1);
    }
    state.time = begun + macro_step;
    ++state.steps;
  }
  end();
}

}  // namespace pliant
