#pragma once

#include <algorithm>
#include <memory>
#include <tuple>

#include <pliant/backend/copy_values.hpp>
#include <pliant/body/adaptation_record.hpp>
#include <pliant/body/group.hpp>
#include <pliant/body/group_statistics.hpp>
#include <pliant/body/integrator_state.hpp>
#include <pliant/body/step_schedule.hpp>
#include <pliant/body/when_asked.hpp>
#include <pliant/constraint/condition.hpp>
#include <pliant/topology/topology.hpp>

namespace pliant {

/// Work that is summed where loops run, J: of changes of loads, of mass damping, of driven nodes, of
/// pressures; of changes of group, what no element knows alone (see book_switching); and of patches that fall asleep or
/// wake. `unbooked` counts the
/// changes of loads whose work is not finite, and so is in no sum; `stiffened` the moves since the step was chosen
/// to groups in which elements are stiffer than it allows.
enum class Work : int {
  changed_loads,
  damping,
  motions,
  pressures,
  switching,
  sleep,
  unbooked,
  stiffened,
  count
};

/// What a run changes of the elements of one type, in internal order.
template <Backend B, int Groups>
struct GroupState {
  typename B::template Array<Tag> tags;                               // (elements): their groups
  typename B::template Array<typename B::scalar> internal_variables;  // (variables, elements)
  /// (elements): at which level of local time steps each is stable; empty without them.
  typename B::template Array<StepLevel> step_levels;
  /// (elements): how distorted each was when its level was chosen.
  typename B::template Array<typename B::scalar> step_distortions;
  GroupStatistics<B, Groups> statistics;

  template <class Visit, class... S>
  static void for_each_member(Visit const& visit, S&... s) {
    visit("groups", s.tags...);
    visit("internal variables", s.internal_variables...);
    visit("step levels", s.step_levels...);
    visit("distortions at step levels", s.step_distortions...);
    visit("statistics kept", s.statistics.open...);
    visit("steps of the last switches", s.statistics.since...);
    visit("numbers of switches", s.statistics.switches...);
    visit("counters of switches", s.statistics.counters...);
  }
};

/// Everything that a run changes. for_each_member is the one list of it: copies, comparison, roll-back and
/// files follow from it.
template <Backend B, class M, class... Fs>
struct State;

template <Backend B, Element... Es, class... Fs>
struct State<B, Mesh<Es...>, Fs...> {
  static constexpr int dim = Mesh<Es...>::dim;
  using T = typename B::scalar;
  template <class U>
  using Array = typename B::template Array<U>;
  template <class E>
  static constexpr int groups_on = detail::FormulationsOf<E, detail::TypeList<>, Fs...>::type::size;

  WhenAsked<Topology<Mesh<Es...>>> topology;  // shared by copies
  WhenAsked<Prescribed<dim>> prescribed;      // shared by copies
  Array<T> u, v;       // (nodes, 4), m and m/s; v is a pending half-kick behind `time`
  Array<T> load;       // (nodes, 4), N, as the user set it; empty while there is none
  Array<double> work;  // (Work::count), J
  std::tuple<GroupState<B, groups_on<Es>>...> elements;
  Point<dim> gravity{};          // m/s²
  double damping = 0;            // 1/s
  double time = 0;               // s
  double pending_half_kick = 0;  // s: by which velocities are behind `time`
  double step_size = 0;          // s: of laws with internal variables, since they were committed
  double energy_of_steps = 0;    // J: what changes of the step added to what leapfrog keeps
  double energy_by_hand = 0;     // J: what a user's changes of the state added since a run began
  std::int64_t steps = 0;
  /// (patches of all types): for how many steps each has been at rest; negative while it sleeps. Empty where
  /// nothing looks for rest.
  Array<std::int32_t> rest;
  std::int64_t rest_seen = 0;   // at which step that was looked at
  std::int64_t rest_until = 0;  // the step by which it has to be looked at again
  double relaxed_until = 0;     // s: to which internal variables of sleeping patches have relaxed
  FrequencyBounds bounds;  // of all that was awake when the step was chosen last, or mesh changed
  AdaptationRecord<dim> record;
  IntegratorState integrator;
  ImplicitState<B> implicit;

  /// visit(name, member of each state...).
  template <class Visit, class... S>
  static void for_each_member(Visit const& visit, S&... s) {
    visit("topology", s.topology...);
    visit("conditions and pressures", s.prescribed...);
    visit("displacements", s.u...);
    visit("velocities", s.v...);
    visit("loads", s.load...);
    visit("work", s.work...);
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      auto const of_type = [&](auto&... elements) {
        std::remove_cvref_t<std::tuple_element_t<0, std::tuple<decltype(elements)...>>>::
            for_each_member(visit, elements...);
      };
      auto const at = [&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
        of_type(std::get<K>(s.elements)...);
      };
      (at(std::integral_constant<std::size_t, I>{}), ...);
    }(std::index_sequence_for<Es...>());
    visit("gravity", s.gravity...);
    visit("damping", s.damping...);
    visit("time", s.time...);
    visit("pending half-kick", s.pending_half_kick...);
    visit("step of internal variables", s.step_size...);
    visit("energy of changes of the step", s.energy_of_steps...);
    visit("energy added by hand", s.energy_by_hand...);
    visit("steps", s.steps...);
    visit("steps at rest", s.rest...);
    visit("step of the last look for rest", s.rest_seen...);
    visit("step of the next look for rest", s.rest_until...);
    visit("time to which sleeping patches are relaxed", s.relaxed_until...);
    visit("bounds of frequencies", s.bounds...);
    AdaptationRecord<dim>::for_each_member(visit, s.record...);
    visit("integrator", s.integrator...);
    ImplicitState<B>::for_each_member(visit, s.implicit...);
  }
};

namespace detail {
/// Makes a member what another is: arrays where they lie, so that recorded loops stay right.
template <class B>
struct CopyMember {
  B const& backend;

  template <class U>
  void operator()(char const*, U const& from, U& to) const {
    if constexpr (requires { to = from; }) {
      to = from;
    } else {
      using Value = std::remove_cvref_t<decltype(*to.data())>;
      if (to.size() != from.size()) to = zeros<Value>(backend, from.size());
      copy_values<B, Value>(backend, from.data(), to.data(), from.size());
    }
  }
};
/// Makes a member what another is, but for arrays.
struct CopyMemberOnHost {
  template <class U>
  void operator()(char const*, U const& from, U& to) const {
    if constexpr (requires { to = from; }) to = from;
  }
};
}  // namespace detail

/// Makes `to` the same as `from`, of the same body. Meshes and conditions are shared, arrays copied.
template <class B, class S>
void copy_state(B const& backend, S const& from, S& to) {
  S::for_each_member(detail::CopyMember<B>{backend}, from, to);
}
/// The same but for arrays that belong to a topology: they stay as they are.
template <class B, class S>
void copy_state_without_arrays(B const& backend, S const& from, S& to) {
  S::for_each_member(detail::CopyMemberOnHost{}, from, to);
  detail::CopyMember<B>{backend}("work", from.work, to.work);
}

}  // namespace pliant
