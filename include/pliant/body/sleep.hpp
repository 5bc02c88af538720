#pragma once

#include <algorithm>
#include <bit>
#include <span>
#include <utility>
#include <vector>

#include <pliant/body/internal_variables.hpp>
#include <pliant/body/leapfrog_energy.hpp>
#include <pliant/body/patch_nodes.hpp>
#include <pliant/body/wake.hpp>

// Patches that sleep. State::rest says which do; all else here follows from it.
namespace pliant {

namespace detail {

/// Tells each node what sleeps and what is awake around it.
struct WatchNodes {
  Index const *first, *pieces, *patch;
  std::uint8_t const* asleep;
  DirectionMask const* held;
  NodeWatch* nodes;
  DirectionMask* still;
  DirectionMask all;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    NodeWatch watch = 0;
    for (Index k = first[i]; k < first[i + 1]; ++k)
      watch |= asleep[patch[pieces[k]]] ? beside_asleep : beside_awake;
    nodes[i] = watch;
    still[i] = watch & beside_asleep ? all : held[i];
  }
};

/// Room for a list of so many patches, a little more, so that it seldom changes: a GPU starts a block for each place
/// of a list, whatever is in it. A few places it starts in no time, so that short lists have room for all.
inline Index room_for(Index count, Index most) {
  constexpr Index few = 512;
  if (most <= few) return most;
  Index const step = std::max<Index>(
      16, static_cast<Index>(std::bit_floor(static_cast<std::uint32_t>(count))) / 8);
  return std::min(most, (count / step + 1) * step);
}

/// Brings a list for over() or over_moving_nodes up to some numbers, of `most` at most. Returns whether it lies elsewhere
/// now; otherwise recorded loops read it as it is.
template <class B>
bool fill_list(B const& backend, typename B::template Array<Index>& list,
               std::vector<Index> numbers, Index most) {
  auto const count = static_cast<Index>(numbers.size());
  numbers.insert(numbers.begin(), count);
  numbers.resize(static_cast<std::size_t>(room_for(count, most)) + 1);
  if (list.size() == numbers.size()) {
    list.upload(numbers);
    return false;
  }
  list = upload(backend, numbers);
  return true;
}

/// Brings lists for over() up to those patches of each type of which `chosen(patch)` holds. Returns whether they
/// lie elsewhere now; otherwise recorded loops read them as they are.
template <class Parts, class Chosen>
bool fill_lists(Parts& parts, std::vector<typename Parts::template Array<Index>>& lists,
                Chosen const& chosen) {
  auto const& first = parts.patch_nodes->first_of_type;
  lists.resize(first.size() - 1);
  bool moved = false;
  for (std::size_t type = 0; type < lists.size(); ++type) {
    std::vector<Index> list;
    for (Index p = first[type]; p < first[type + 1]; ++p)
      if (chosen(static_cast<std::size_t>(p))) list.push_back(p - first[type]);
    moved = fill_list(parts.backend, lists[type], std::move(list), first[type + 1] - first[type]) ||
            moved;
  }
  return moved;
}

/// Whether a run of nodes has one beside what is awake.
struct HasAwakeNode {
  NodeWatch const* nodes;
  Index count;
  PLIANT_HOST_DEVICE bool operator()(Index run) const {
    Index const first = run * nodes_of_run, left = count - first;
    NodeWatch all = 0;  // of the run's, without a branch for each
    for (Index k = 0; k < (left < nodes_of_run ? left : nodes_of_run); ++k) all |= nodes[first + k];
    return (all & beside_awake) != 0;
  }
};
/// Brings the list of runs of nodes up to what nodes watch. Returns whether it lies elsewhere now.
template <class Parts>
bool list_runs(Parts& parts) {
  Index const rows = parts.layout.rows, most = (rows + nodes_of_run - 1) / nodes_of_run;
  return fill_list(parts.backend, parts.patch_nodes->awake_runs,
                   parts.backend.select(most, HasAwakeNode{parts.awake->nodes.data(), rows}), most);
}

/// Whether a piece lies beside a patch that is awake.
struct IsBesideAwake {
  Index const *first, *beside, *patch;
  std::uint8_t const* asleep;
  PLIANT_HOST_DEVICE std::uint8_t operator()(Index piece) const {
    for (Index k = first[piece]; k < first[piece + 1]; ++k)
      if (asleep[patch[beside[k]]] == 0) return 1;
    return 0;
  }
};
/// Which patches lie beside others that are awake; all, where terms may pull anywhere.
template <class Parts>
std::vector<std::uint8_t> find_beside_awake(Parts& parts) {
  auto const& rows = *parts.patch_nodes;
  if (has_added_terms(parts))
    return std::vector<std::uint8_t>(static_cast<std::size_t>(rows.count()), 1);
  return rows.marks_of_patches(
      parts.backend, IsBesideAwake{rows.first_beside.data(), rows.beside.data(), rows.patch.data(),
                                   parts.awake->asleep.data()});
}

/// Brings parts.awake up to state.rest, which is also on the host.
template <class Parts>
void bring_up_to_rest(Parts& parts, std::span<std::int32_t const> rest) {
  using T = typename Parts::T;
  bool const slept = parts.awake.has_value();
  if (std::ranges::none_of(rest, [](std::int32_t steps) { return steps < 0; })) {
    if (!slept) return;
    forget_forces(parts);
    parts.awake.reset();
    ++parts.revision;
    return;
  }
  auto const& backend = parts.backend;
  if (!parts.patch_nodes) parts.patch_nodes.emplace(make_patch_nodes(parts));
  auto const& patch_nodes = *parts.patch_nodes;
  auto const nodes = static_cast<std::size_t>(parts.layout.rows);
  if (!slept) {
    auto& awake = parts.awake.emplace();
    awake.asleep = zeros<std::uint8_t>(backend, rest.size());
    awake.nodes = zeros<NodeWatch>(backend, nodes);
    awake.still = zeros<DirectionMask>(backend, nodes);
    awake.kept = zeros<T>(backend, parts.layout.f.size());
    ++parts.revision;
  }
  auto& awake = *parts.awake;
  std::vector<std::uint8_t> asleep(rest.size());
  for (std::size_t p = 0; p < rest.size(); ++p) asleep[p] = rest[p] < 0;
  awake.asleep.upload(asleep);
  awake.awake = static_cast<Index>(std::ranges::count(asleep, 0));
  backend.for_each(
      parts.layout.rows,
      WatchNodes{patch_nodes.first.data(), patch_nodes.pieces.data(), patch_nodes.patch.data(),
                 awake.asleep.data(), parts.layout.held.data(), awake.nodes.data(),
                 awake.still.data(), all_directions<Parts::dim>});
  bool const patches_moved =
      fill_lists(parts, awake.patches, [&](std::size_t p) { return !asleep[p]; });
  if (list_runs(parts) || patches_moved) ++parts.revision;

  // What sleeping patches pull at, where something is awake; everywhere, where terms may pull too.
  std::vector<typename Parts::template Array<Index>> beside;
  auto const is_beside = find_beside_awake(parts);
  (void)fill_lists(parts, beside, [&](std::size_t p) { return asleep[p] && is_beside[p]; });
  typename Parts::Field const kept{awake.kept.data()};
  clear_rows(parts, kept);
  ElementGroups<typename Parts::layout_type>(parts.layout, &beside)
      .add_force(backend, std::as_const(parts).here(), kept);
  parts.layout.interpolation.apply_transpose(backend, kept);
  forget_forces(parts);
}

}  // namespace detail

/// Internal variables of sleeping patches relax by the time since they last did, at the displacements that these have
/// kept: exactly, where a law integrates that exactly.
template <class Parts>
void relax_what_sleeps(Parts& parts) {
  if constexpr (Parts::has_internal_variables) {
    auto& state = parts.state;
    double const passed = state.time - std::exchange(state.relaxed_until, state.time);
    if (!parts.awake || !(passed > 0)) return;
    std::vector<typename Parts::template Array<Index>> lists;
    auto const asleep = on_host<std::uint8_t>(parts.awake->asleep);
    (void)detail::fill_lists(parts, lists, [&](std::size_t p) { return asleep[p] != 0; });
    WithStepSize const relaxing(parts, passed);
    commit_of(parts, std::as_const(parts).u(), [&]<class Table>(Table const& table) {
      constexpr std::size_t type = Parts::layout_type::template type_of<typename Table::element>;
      return over(table.elements, lists[type]);
    });
  }
}

/// Changes state.rest, to wake patches or to put them to sleep; those lose their velocity. What that changes of the energy that
/// is watched is booked, J.
template <class Parts>
void change_rest(Parts& parts, std::span<std::int32_t const> rest) {
  using T = typename Parts::T;
  synchronize_velocities(parts);
  relax_what_sleeps(parts);
  double const step = parts.add_watched_term ? parts.state.integrator.step : 0;
  Sums<4, typename Parts::backend_type> sums(parts.backend);
  auto const add = [&](double* to) {
    add_kinetic_energy(parts, to);
    if (step > 0) add_acceleration_term(parts, to + 1);
  };
  add(sums.data());
  parts.state.rest.upload(rest);
  detail::bring_up_to_rest(parts, rest);
  if (parts.awake) {
    parts.backend.for_each(parts.layout.rows, StopHeld<T, Parts::dim>{parts.v(), parts.still()});
    parts.layout.interpolation.apply(parts.backend, parts.v());
  }
  add(sums.data() + 2);
  auto const [kinetic_before, term_before, kinetic, term] = sums.read();
  double const added = step * step * (term - term_before);
  parts.state.integrator.last_energy += added;
  book(parts, Work::sleep, kinetic - kinetic_before - added);
}

namespace detail {

/// See follow_rest.
template <class Parts>
void follow_state_of_rest(Parts& parts) {
  auto& rest = parts.state.rest;
  if (rest.size() > 0 && rest.size() != patch_count(parts)) rest = {};
  bring_up_to_rest(parts, on_host<std::int32_t>(rest));
}
/// See wake_all.
template <class Parts>
void wake_what_sleeps(Parts& parts) {
  std::vector<std::int32_t> const none(parts.state.rest.size());
  if (parts.awake)
    change_rest(parts, none);
  else
    parts.state.rest.upload(none);
}
/// See wake_nodes.
template <class Parts>
void wake_around(Parts& parts, std::span<Index const> nodes) {
  if (!parts.awake) return;
  auto const& rows = *parts.patch_nodes;
  auto pieces = zeros<std::uint8_t>(parts.backend, static_cast<std::size_t>(rows.pieces_count()));
  auto const listed = upload(parts.backend, nodes);
  parts.backend.for_each(
      static_cast<Index>(nodes.size()),
      MarkAtNodes{listed.data(), rows.first.data(), rows.pieces.data(), pieces.data()});
  auto const marked = rows.marks_of_patches(parts.backend, MarkOfPiece{pieces.data()});
  auto rest = download<std::int32_t>(parts.state.rest);
  bool wakes = false;
  for (std::size_t p = 0; p < rest.size(); ++p) {
    if (!marked[p] || rest[p] >= 0) continue;
    rest[p] = 0;
    wakes = true;
  }
  if (wakes) change_rest(parts, rest);
}

template <class Parts>
inline constexpr SleepVerbs<Parts> sleep_verbs{follow_state_of_rest<Parts>, wake_what_sleeps<Parts>,
                                               wake_around<Parts>};

}  // namespace detail

/// Lets patches of a body sleep from now on.
template <class Parts>
void let_sleep(Parts& parts) {
  parts.sleep = &detail::sleep_verbs<Parts>;
}

}  // namespace pliant
