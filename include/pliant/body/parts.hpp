#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>

#include <pliant/backend/patch_list.hpp>
#include <pliant/body/awake_set.hpp>
#include <pliant/body/host_changes.hpp>
#include <pliant/body/layout.hpp>
#include <pliant/body/looker.hpp>
#include <pliant/body/solver_arrays.hpp>
#include <pliant/body/state.hpp>
#include <pliant/body/step_schedule.hpp>
#include <pliant/body/timers.hpp>
#include <pliant/constraint/driven_nodes.hpp>
#include <pliant/error.hpp>
#include <pliant/force/element_groups.hpp>
#include <pliant/force/force_term.hpp>
#include <pliant/topology/topology_change.hpp>

namespace pliant {

/// The parts of a body's energy, J.
struct Energies {
  double strain = 0, kinetic = 0, potential = 0;
  double total() const { return strain + kinetic + potential; }
};

/// The energies at a time, and what leapfrog's own, which its steps keep, has less: Δt² Σ m a²/8, J.
struct WatchedEnergy {
  Energies energies{};
  double acceleration = 0;
  double kept() const { return energies.total() - acceleration; }
};

template <class M, Backend B>
struct TopologyOn;
template <Backend B>
struct ChangedRows;
template <class M, Backend B>
class BackendChange;

/// What it takes where patches sleep: see body/wake.hpp.
template <class Parts>
struct SleepVerbs {
  void (*follow_rest)(Parts&);
  void (*wake_all)(Parts&);
  void (*wake_nodes)(Parts&, std::span<Index const>);
};

/// What a body is made of, for integrators, solvers and adaptation. Plain data: each function on it stands
/// with its purpose (force/, constraint/, solver/, adaptation/).
template <Backend B, class M, class... Fs>
struct Parts {
  static constexpr int dim = M::dim;
  /// Whether a law has internal variables: see LawWithInternalVariables.
  static constexpr bool has_internal_variables = ((internal_variables_of<Fs> > 0) || ...);
  /// Whether the stress of a law depends on how fast it deforms: see depends_on_rate.
  static constexpr bool has_dashpots = (depends_on_rate<typename Fs::template law<double>> || ...);
  using T = typename B::scalar;
  using backend_type = B;
  using mesh_type = M;
  using layout_type = Layout<B, M, Fs...>;
  using state_type = State<B, M, Fs...>;
  using Field = NodeField<T, dim>;
  using ConstField = NodeField<T const, dim>;
  using Terms = std::vector<std::unique_ptr<AnyForceTerm<B, dim>>>;
  template <class U>
  using Array = typename B::template Array<U>;

  B backend;
  Elastic material;
  std::tuple<Group<Fs>...> groups;
  MeshLimits limits{};
  std::shared_ptr<Topology<M> const> first{};  // which saved states do not repeat

  state_type state{};
  layout_type layout;
  /// While the mesh is changed in the backend's memory.
  std::shared_ptr<TopologyOn<M, B>> topology_on{};
  HostChanges host_changes{};  // of the mesh

  Terms pressures{};  // of state.prescribed
  /// Makes them; set once there is a pressure, so that other bodies do not compile it.
  void (*upload_pressures)(Parts&) = nullptr;
  Terms terms{};  // the user's own
  /// Makes one, from the rows of fields that nodes have.
  using MakeTerm =
      std::function<std::unique_ptr<AnyForceTerm<B, dim>>(B const&, NodeRows const& rows)>;
  std::vector<MakeTerm> term_makers{};
  std::vector<DrivenNodes<B, dim>> driven{};
  std::map<std::string, Motion<dim>> motions{};  // all that were ever given, by name
  Array<T> before_drives{};                      // see place_before_drives
  std::vector<std::function<void(TopologyChange<M> const&)>> listeners{};
  std::vector<std::function<void(BackendChange<M, B> const&)>> backend_listeners{};
  bool is_telling = false;  // them of a change

  bool forces_current = false;   // while they are not, the nodes' rows of layout.f are zero
  bool forces_complete = false;  // whether these are the forces of sleeping patches too
  bool loads_current = false;    // whether layout.load has state.load, those of slaves handed on
  long revision = 0;             // changes whenever recorded kernels would no longer be right
  std::optional<state_type> checkpoint{};
  bool has_checkpoint = false;  // of the present mesh, with no change by hand since
  /// Adds Σ m a²/8 of WatchedEnergy, J/s², to *to in the backend's memory; set by an integrator that watches energies, else null.
  void (*add_watched_term)(Parts&, double* to) = nullptr;
  /// Raises the bounds of frequencies of the parts behind a change of the mesh; set by an integrator that steps by them.
  void (*raise_bounds)(Parts const& before, Parts& next, ChangedRows<B>&) = nullptr;
  /// Of the integrator that stepped last; null: any. It lives on here: another integrator where
  /// that one was in memory is not taken for it.
  std::shared_ptr<void const> integrator{};
  std::vector<Looker> lookers{};  // see detail::look_key
  struct Recorded {
    double dt;
    long revision;
    std::shared_ptr<void const> look{};  // of which adaptation; null: of none
    int steps = 1;
    std::optional<typename B::Recording> recording{};
    int unrecorded = 0;  // how many steps were taken before there was one
  };
  std::optional<Recorded> recorded{};          // a step
  std::optional<Recorded> recorded_stretch{};  // several
  std::optional<Recorded> recorded_onward{};   // the same, where the forces of the first are known
  std::optional<Recorded> recorded_with_look{};  // and a look of an adaptation behind them
  std::optional<StepSchedule<B>> schedule{};     // of local time steps; see solver/local_steps.hpp
  std::optional<PatchNodes<B>> patch_nodes{};    // made when something first looks for rest
  std::optional<AwakeSet<B>> awake{};            // while patches sleep; see body/sleep.hpp
  /// Set once something looks for rest, so that other bodies do not compile it: see let_sleep.
  SleepVerbs<Parts> const* sleep = nullptr;
  struct Scratch {
    Array<T> u, du, f;
  };
  std::optional<Scratch> scratch{};
  std::optional<SolverArrays<B>> solver{};  // made when a solver first runs on the backend
  Array<T> without_energy{};    // (nodes, 4) and scratch rows, N: of terms that have no energy
  Array<double> moves{};        // (1): how many elements a look moves between groups
  Array<std::int64_t> clock{};  // (1): the number of steps at that look
  Array<T> row_sums{};          // (nodes, 4) and scratch rows, of the stable step
  mutable Array<double> no_counters{};  // empty: of visitors that tally nothing
  AdaptationTimers<B> timers{};

  Field u() { return node_field<dim>(state.u); }
  Field v() { return node_field<dim>(state.v); }
  Field f() { return node_field<dim>(layout.f); }
  ConstField u() const { return node_field<dim>(state.u); }
  ConstField v() const { return node_field<dim>(state.v); }
  ConstField rest() const { return node_field<dim>(layout.rest); }
  /// Where forces are asked: at displacements, of this body or another's arrays.
  Placement<T, dim> at(ConstField displacements) const { return {rest(), displacements}; }
  Placement<T, dim> here() const { return at(u()); }
  ElementGroups<layout_type> elements() const { return ElementGroups<layout_type>(layout); }
  /// Those of patches that are awake.
  ElementGroups<layout_type> awake_elements() const {
    return ElementGroups<layout_type>(layout, awake ? &awake->patches : nullptr);
  }

  /// The elements of a table's patches that are awake, for verbs.
  template <class Table>
  auto awake_in(Table const& table) const {
    constexpr std::size_t type = layout_type::template type_of<typename Table::element>;
    return awake ? over(table.elements, awake->patches[type]) : detail::active(table.elements);
  }
  /// (nodes): the directions in which nodes do not move, held or asleep.
  DirectionMask const* still() const { return awake ? awake->still.data() : layout.held.data(); }

  /// visit(table, element state) for each element type.
  template <class Visit>
  void for_each_type(Visit const& visit) {
    for_each(visit, layout.tables, state.elements);
  }
  template <class Visit>
  void for_each_type(Visit const& visit) const {
    for_each(visit, layout.tables, state.elements);
  }
  template <class F>
  auto law_of() const {
    return std::get<Group<F>>(groups).law_for(material);
  }

 private:
  template <class Visit, class Tables, class States>
  static void for_each(Visit const& visit, Tables& tables, States& states) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (visit(std::get<I>(tables), std::get<I>(states)), ...);
    }(std::make_index_sequence<std::tuple_size_v<std::remove_cvref_t<Tables>>>());
  }
};

namespace detail {

/// Throws Error where a listener asks for something that is told of a change of the mesh: others are still to be told of that.
template <class Parts>
void check_nobody_is_told(Parts const& parts, char const* what) {
  if (parts.is_telling)
    throw Error(what, ": a listener (on_change) asks for it that is told of a change of the mesh; ",
                "ask for it when that is done");
}

}  // namespace detail

/// A body that integrators, solvers and adaptation take: it has parts, and a state that they advance.
template <class TheBody>
concept DeformableBody = requires(std::remove_const_t<TheBody>& body) {
  typename TheBody::backend_type;
  typename TheBody::scalar;
  typename TheBody::mesh_type;
  { body.parts() } -> std::same_as<typename TheBody::parts_type&>;
  { body.time() } -> std::convertible_to<double>;
  { body.steps() } -> std::convertible_to<std::int64_t>;
};

/// What the law of F reads of the first element of its type, or zeros where there is none.
template <class F, class Parts>
std::array<double, element_values<F>> first_values(Parts const& parts) {
  std::array<double, element_values<F>> values{};
  if constexpr (element_values<F> > 0) {
    using Layout = typename Parts::layout_type;
    using Table = typename Layout::template Table<typename F::element>;
    auto const& all =
        parts.state.topology->element_values[Layout::template type_of<typename F::element>];
    constexpr auto first =
        std::size_t{Table::Laws::template first_value<Table::template group_of<F>>()};
    for (std::size_t k = 0; k < values.size() && first + k < all.size(); ++k)
      values[k] = all[first + k];
  }
  return values;
}

}  // namespace pliant
