#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <pliant/adaptation/stirred.hpp>

// Looks for patches that come to rest, and for sleeping ones that something pulls at.
namespace pliant {

namespace detail {
/// How many patches beside a stirred one a wave crosses until the next look, if that comes after so many steps, and one at
/// least: it goes a node a step where steps are as long as they may be, and a patch is as wide as its share of the nodes.
template <class Parts>
int rings_reached(Parts const& parts, std::int64_t steps) {
  double const nodes_of_patch = static_cast<double>(parts.layout.rows) / parts.patch_nodes->count();
  double const width = std::pow(nodes_of_patch, 1.0 / Parts::dim);
  constexpr double most = 250;  // that marks can number
  return static_cast<int>(std::lround(std::clamp(static_cast<double>(steps) / width, 1.0, most)));
}

/// How State::rest goes on where `passed` steps were taken since the last look.
struct NextRest {
  std::int32_t passed, for_steps;
  PLIANT_HOST_DEVICE std::int32_t operator()(std::int32_t rest, bool stirred) const {
    std::int32_t const longer = rest + passed, still = longer >= for_steps ? -1 : longer;
    return stirred ? 0 : rest < 0 ? rest : still;
  }
};

/// Lets the rest of a patch go on, but where the patch would fall asleep or wake: there it tells so, by 1, and leaves it to the
/// host. The marks of its pieces become those with which a look begins.
struct GoOn {
  NextRest next;
  Index const* first_other;
  std::uint8_t const* driven;
  std::uint8_t *stirred, *turns;
  std::int32_t* rest;

  PLIANT_HOST_DEVICE double operator()(Index p) const {
    bool moves = take(p);
    for (Index piece = first_other[p]; piece < first_other[p + 1]; ++piece)
      moves = take(piece) || moves;
    std::int32_t const before = rest[p], after = next(before, moves);
    bool const turned = (before ^ after) < 0;  // another sign
    turns[p] = turned;
    if (!turned) rest[p] = after;
    return turned;
  }
  /// Whether a piece has a mark, which it loses.
  PLIANT_HOST_DEVICE bool take(Index piece) const {
    bool const marked = stirred[piece] != 0;
    stirred[piece] = driven[piece];
    return marked;
  }
};
/// Brings State::rest up to the marks of a look where no patch falls asleep or wakes. Returns whether one would.
template <class Parts>
bool go_on(Parts& parts, NextRest const& next) {
  auto& rows = *parts.patch_nodes;
  return parts.backend.maximum(rows.count(), GoOn{next, rows.first_other.data(), rows.driven.data(),
                                                  rows.stirred.data(), rows.turns.data(),
                                                  parts.state.rest.data()}) > 0;
}

/// Puts to sleep and wakes what go_on has left, but for patches whose points relax, which are not at rest.
template <class Parts>
void turn(Parts& parts, SleepRule const& rule) {
  auto rest = download<std::int32_t>(parts.state.rest);
  auto const turns = on_host<std::uint8_t>(parts.patch_nodes->turns);
  auto const falls_asleep = [&](std::size_t p) { return turns[p] && rest[p] >= 0; };
  std::vector<std::uint8_t> relaxing(rest.size());
  if constexpr (Parts::has_internal_variables) {
    bool some = false;
    for (std::size_t p = 0; p < rest.size(); ++p) some = some || falls_asleep(p);
    if (some) relaxing = find_relaxing(parts, rule);
  }
  bool changes = false;
  for (std::size_t p = 0; p < rest.size(); ++p) {
    if (!turns[p]) continue;
    bool const sleeps = falls_asleep(p) && !relaxing[p];
    changes = changes || sleeps || rest[p] < 0;
    rest[p] = sleeps ? -1 : 0;
  }
  if (changes)
    change_rest(parts, rest);
  else
    parts.state.rest.upload(rest);
}
}  // namespace detail

/// Wakes patches that something would move, and those that it may reach before the next look, and puts those to sleep that have been at rest for long enough. Before
/// an integrator with a step has taken the body, nothing sleeps. A look holds for `for_steps` steps: without another
/// one, all wakes then.
template <class Parts>
void look_for_rest(Parts& parts, SleepRule const& rule) {
  auto& state = parts.state;
  if (!(state.integrator.step > 0) || state.integrator.macro_step > 0) return;
  state.rest_until = state.steps + rule.for_steps;
  if (parts.awake && parts.awake->awake == 0 && !has_added_terms(parts)) {
    state.rest_seen = state.steps;  // what could stir would have woken it
    return;
  }
  let_sleep(parts);
  if (!parts.patch_nodes) parts.patch_nodes.emplace(detail::make_patch_nodes(parts));
  auto const count = static_cast<std::size_t>(parts.patch_nodes->count());
  if (state.rest.size() != count) {
    state.rest = zeros<std::int32_t>(parts.backend, count);
    state.rest_seen = state.steps;
  }
  auto const passed = static_cast<std::int32_t>(
      std::min<std::int64_t>(state.steps - state.rest_seen, rule.for_steps));
  state.rest_seen = state.steps;
  detail::mark_stirred(parts, rule, detail::rings_reached(parts, passed));
  if (detail::go_on(parts, {passed, static_cast<std::int32_t>(rule.for_steps)}))
    detail::turn(parts, rule);
}

namespace detail {
/// The force on a node that sleeps, N.
template <class T, int Dim>
struct HiddenForce {
  NodeField<T const, Dim> f;
  T const* mass;
  DirectionMask const* held;
  NodeWatch const* watch;
  ExternalForces<T, Dim> external;

  PLIANT_HOST_DEVICE double operator()(Index i) const {
    T const m = mass[i];
    if (!(m > T(0)) || !(watch[i] & beside_asleep)) return 0;
    auto const a = acceleration_of(i, f, m, held[i], external);
    return infinite_if_not_finite(static_cast<double>(m * sqrt(dot(a, a))));
  }
};
}  // namespace detail

/// What sleeps in a body.
struct Asleep {
  Index patches = 0, of_patches = 0;
  double residual = 0;  // N: the largest force on a node that is kept where it is
  double energy =
      0;  // J: what falling asleep took and waking gave, all in all; at most 0, steps aside
};

/// Evaluates the forces of all elements.
template <DeformableBody TheBody>
Asleep asleep(TheBody& body) {
  auto& parts = body.parts();
  using T = typename TheBody::scalar;
  Asleep found;
  found.energy = download<double>(parts.state.work)[static_cast<std::size_t>(Work::sleep)];
  if (!parts.awake) return found;
  found.of_patches = parts.patch_nodes->count();
  found.patches = found.of_patches - parts.awake->awake;
  evaluate_all_forces(parts);
  found.residual = parts.backend.maximum(
      parts.layout.rows, detail::HiddenForce<T, TheBody::dim>{{parts.layout.f.data()},
                                                              parts.layout.mass.data(),
                                                              parts.layout.held.data(),
                                                              parts.awake->nodes.data(),
                                                              external_forces(parts)});
  return found;
}

namespace detail {
template <Element E, class Parts>
std::vector<bool> asleep_on(Parts const& parts) {
  auto const& table = parts.layout.template table<E>();
  std::vector<bool> sleeps(static_cast<std::size_t>(table.count()), false);
  if (!parts.awake) return sleeps;
  auto const asleep = on_host<std::uint8_t>(parts.awake->asleep);
  Index const first = parts.patch_nodes->first_of_type[Parts::layout_type::template type_of<E>];
  auto const& user = table.user_elements();
  auto const bounds = table.elements.patch_bounds();
  for (Index p = 0; p < table.elements.patch_count(); ++p) {
    bool const own = asleep[static_cast<std::size_t>(first + p)] != 0;
    auto const k = static_cast<std::size_t>(p);
    for (auto e = static_cast<std::size_t>(bounds[k]); e < static_cast<std::size_t>(bounds[k + 1]);
         ++e)
      sleeps[static_cast<std::size_t>(user[e])] = own;
  }
  return sleeps;
}
}  // namespace detail

/// Which elements of a type sleep, by the user's number.
template <Element E, DeformableBody TheBody>
std::vector<bool> asleep_elements(TheBody const& body) {
  return detail::asleep_on<E>(body.parts());
}

}  // namespace pliant
