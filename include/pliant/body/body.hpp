#pragma once

#include <cmath>
#include <utility>

#include <pliant/body/check_field.hpp>
#include <pliant/body/history.hpp>
#include <pliant/body/layout.hpp>
#include <pliant/body/pressure.hpp>
#include <pliant/body/timers.hpp>
#include <pliant/mesh/check.hpp>

namespace pliant {

/// A deformable body: nodes, elements in groups of formulations, conditions and loads, on one backend
/// in one precision. It moves, and is not copied. Everything a user hands in or reads is in the user's
/// own order of nodes and elements.
template <Backend B, class M, class... Fs>
class Body {
 public:
  static constexpr int dim = M::dim;
  /// Whether a law has internal variables: see LawWithInternalVariables.
  static constexpr bool has_internal_variables = ((internal_variables_of<Fs> > 0) || ...);
  using backend_type = B;
  using scalar = typename B::scalar;
  using T = scalar;
  using mesh_type = M;
  using layout_type = Layout<B, M, Fs...>;
  using Field = NodeField<T, dim>;
  using ConstField = NodeField<T const, dim>;

  /// Checks the mesh and the material (throws Error) and starts at rest, undeformed. All elements of
  /// a type start in the first group given for that type.
  Body(B backend, M mesh, Elastic const& material, Group<Fs>... groups)
      : backend_(std::move(backend)),
        material_(material.checked()),
        groups_(std::move(groups)...),
        layout_(first_layout(std::move(mesh))) {}

  // What it is made of.
  B const& backend() const { return backend_; }
  Elastic const& material() const { return material_; }
  M const& mesh() const { return layout_.mesh; }
  Index nodes() const { return layout_.nodes; }
  double time() const { return time_; }  // s
  long steps() const { return steps_; }
  /// The group of each element, as the number among the groups given for its type.
  template <Element E>
  std::vector<Tag> groups_of() const;
  /// Puts elements into the group of a formulation.
  template <class F>
  void assign(std::vector<Index> const& elements);
  /// Lumped masses of the nodes, kg; those of slaves are with their masters.
  std::vector<double> const& masses() const { return layout_.mass_list; }

  // What holds and pulls it.
  void clamp(std::vector<Facet<dim>> const& facets) { hold(facets, all_directions<dim>); }
  void clamp(std::vector<Index> const& nodes) { hold(nodes, all_directions<dim>); }
  /// Holds directions (bit k: direction k) where they are now.
  void hold(std::vector<Facet<dim>> const& facets, DirectionMask directions) {
    add_condition({facets, nodes_of(facets), directions, {}});
  }
  void hold(std::vector<Index> const& nodes, DirectionMask directions) {
    add_condition({{}, nodes, directions, {}});
  }
  /// Moves nodes: their displacement is motion(time).
  void drive(std::vector<Facet<dim>> const& facets, Motion<dim> motion) {
    add_condition({facets, nodes_of(facets), all_directions<dim>, std::move(motion)});
  }
  void drive(std::vector<Index> const& nodes, Motion<dim> motion) {
    add_condition({{}, nodes, all_directions<dim>, std::move(motion)});
  }
  /// A pressure that follows the surface, Pa, positive against the outward normal, on facets of the
  /// boundary told by their corners, from either side. Pressing the same facets again replaces it; 0
  /// ends it. The stable step does not know its stiffness. Throws Error for other facets.
  void press(std::vector<Facet<dim>> const& facets, double pascals);
  std::vector<Pressure<dim>> const& pressures() const { return pressures_; }
  void set_gravity(Point<dim> const& g);                  // m/s²
  void set_damping(double per_mass);                      // 1/s
  void set_load(Index node, Point<dim> const& force);     // N, constant in direction
  void set_loads(std::vector<Point<dim>> const& forces);  // of all nodes; see mesh/loads.hpp
  Point<dim> const& gravity() const { return gravity_; }
  double damping() const { return damping_; }
  std::vector<Point<dim>> const& loads() const { return loads_; }  // empty, or one per node
  std::vector<Condition<dim>> const& conditions() const { return conditions_; }

  // Its state.
  std::vector<Point<dim>> displacements() const { return layout_.in_user_order(layout_.u); }
  std::vector<Point<dim>> velocities();
  void set_displacements(std::vector<Point<dim>> const& u);
  void set_velocities(std::vector<Point<dim>> const& v);
  /// Internal forces −∂W/∂u of the present displacements and those of pressures, N; those of slaves are
  /// with their masters.
  std::vector<Point<dim>> forces();
  double strain_energy() const { return energy_at(layout_.u); }  // J
  double kinetic_energy();                                       // J
  double potential_energy() const;                               // J, of gravity and loads
  double total_energy() { return strain_energy() + kinetic_energy() + potential_energy(); }

  // For a simulator that owns its state: arrays in the backend's memory, node i at [stride i], which
  // are added to and never overwritten. Error where a stride is smaller than the dimension.
  void add_force(T const* u, T* f, int stride = dim);
  /// f += factor · ∂F/∂u · du, at the displacement u.
  void add_tangent_product(T const* u, T const* du, T* f, double factor = 1, int stride = dim);
  double energy(T const* u, int stride = dim);
  void add_lumped_mass(T* m) const;  // (nodes)

  // For solvers and adaptation.
  layout_type& layout() { return layout_; }
  layout_type const& layout() const { return layout_; }
  std::tuple<Group<Fs>...> const& groups() const { return groups_; }
  template <class F>
  auto law_of() const {
    return std::get<Group<F>>(groups_).law_for(material_);
  }
  template <class Visit>
  void for_each_table(Visit const& visit) {
    std::apply([&](auto&... table) { (visit(table), ...); }, layout_.tables);
  }
  template <class Visit>
  void for_each_table(Visit const& visit) const {
    std::apply([&](auto const&... table) { (visit(table), ...); }, layout_.tables);
  }
  Field displacement_field() { return {layout_.u.data()}; }
  ConstField rest_field() const { return {layout_.rest.data()}; }
  ConstField displacement_field() const { return {layout_.u.data()}; }
  /// A half kick behind time() while one is owed().
  ConstField velocity_field() const { return {layout_.v.data()}; }
  ExternalForces<T, dim> external_forces() const;
  /// Brings `layout().f` up to date.
  void evaluate_forces();
  /// Call after a change of displacements or groups.
  void forget_forces();
  /// Velocities and displacements go forward: see Advance. Leaves a half kick of `open` owed.
  void advance(double lag, double kick, double drift);
  /// Laws with internal variables see time steps of this size, s; see LawWithInternalVariables.
  void set_step_size(double step);
  double step_size() const { return step_size_; }
  /// Brings internal variables up to the present displacements.
  void commit();
  /// Brings them to rest: as if the body had always been where it is.
  void equilibrate();
  void owe(double half_kick) { owed_ = half_kick; }
  double owed() const { return owed_; }
  /// Pays the half kick that the last step left open, so that velocities belong to time().
  void synchronize_velocities();
  void prescribe(double time, double over);
  bool has_motions() const;
  void tick(double dt, int steps) {
    time_ += dt;
    steps_ += steps;
  }
  /// Where the time of adaptation goes; timers stand still unless measure_adaptation() was called.
  using Timers = AdaptationTimers<B>;
  Timers& timers() { return timers_; }
  void measure_adaptation() {
    timers_.criteria.timer.emplace(backend_.timer());
    timers_.migration.timer.emplace(backend_.timer());
  }
  History<dim> const& history() const { return history_; }
  /// The largest mesh that refinement may make; one that would be larger throws Error.
  void set_capacity(Capacity capacity) { history_.capacity = capacity; }
  /// A layout of another mesh. `starts`: one for each element type.
  layout_type make_layout(M mesh, std::vector<Slave> slaves,
                          std::vector<ElementStart> const& starts) const {
    return {backend_, std::move(mesh), std::move(slaves), material_, groups_, starts};
  }
  /// Swaps in another mesh; used by refinement.
  void replace(layout_type layout, std::vector<Condition<dim>> conditions,
               std::vector<Pressure<dim>> pressures, std::vector<Point<dim>> loads,
               std::shared_ptr<Hierarchy const> tree,
               std::vector<typename History<dim>::Totals> totals);
  /// Changes whenever kernels recorded for this body would no longer be right.
  long revision() const { return revision_; }
  /// Takes steps of a constant size, with a half kick owed before and after.
  void step(double dt, int steps);
  /// Keeps the present displacements and velocities, for restore().
  void checkpoint();
  /// Goes back to the last checkpoint; false where there is none of the present mesh.
  bool restore();
  /// Negative where there is none: at first, and after its user changed the body's state.
  long checkpoint_step() const { return checkpoint_ ? checkpoint_->steps : -1; }
  /// What changes of gravity and loads have added to the potential energy so far, J.
  double energy_of_new_loads() const { return energy_of_new_loads_; }
  void add_refinement(LedgerEntry<dim> entry) { history_.refinements.push_back(std::move(entry)); }

 private:
  layout_type first_layout(M mesh) const {
    check(mesh);
    auto const starts = first_elements(mesh);
    return make_layout(std::move(mesh), {}, starts);
  }
  template <Element... Es>
  std::vector<ElementStart> first_elements(Mesh<Es...> const& mesh) const {
    return {first_elements_of<Es>(mesh.template elements<Es>().size())...};
  }
  template <Element E>
  ElementStart first_elements_of(std::size_t count) const;
  void add_condition(Condition<dim> condition);
  void upload_pressures();
  void upload_conditions();
  void upload_loads();
  void stop_held();
  template <class Change>
  void change_loads(Change const& change);
  double energy_at(typename B::template Array<T> const& u) const;
  void accumulate_forces(ConstField u, Field f) const;
  void clear(Field field, Index rows) const { backend_.for_each(rows, Clear<T>{field.data}); }
  struct Scratch {
    typename B::template Array<T> u, du, f;
  };
  Scratch& scratch();
  struct Checkpoint {
    typename B::template Array<T> u, v;
    std::vector<typename B::template Array<T>> internal_variables;  // of the tables that have one
    double time, step_size;
    long steps;
  };
  struct RecordedStep {
    typename B::Recording recording;
    Body const* body;  // where it was made: a body that moved records anew
    double dt;
    long revision;
  };

  B backend_;
  Elastic material_;
  std::tuple<Group<Fs>...> groups_;
  layout_type layout_;
  std::vector<Condition<dim>> conditions_;
  std::vector<Pressure<dim>> pressures_;
  SurfaceForces<B, M> surface_forces_;
  void (*press_again_)(Body&) = nullptr;  // set once there is a pressure: others do not compile it
  struct ListedCondition {
    typename B::template Array<Index> nodes;
    std::size_t condition;
  };
  std::vector<ListedCondition> motions_;
  std::vector<Point<dim>> loads_;
  Point<dim> gravity_{};
  double damping_ = 0, time_ = 0, owed_ = 0, energy_of_new_loads_ = 0;
  double step_size_ =
      0;  // s, since internal variables were committed; only laws that have some care
  long steps_ = 0, revision_ = 0;
  bool forces_current_ = false;  // while they are not, the nodes' rows of layout().f are zero
  History<dim> history_;
  std::optional<Scratch> scratch_;
  std::optional<Checkpoint> checkpoint_;
  std::optional<RecordedStep> recorded_;
  Timers timers_;
};

template <Backend B, class M, class... Gs>
Body(B, M, Elastic, Gs...) -> Body<B, M, typename Gs::formulation...>;

}  // namespace pliant

#include <pliant/body/conditions_of_body.hpp>
#include <pliant/body/embedding_of_body.hpp>
#include <pliant/body/groups_of_body.hpp>
#include <pliant/body/motion_of_body.hpp>
#include <pliant/body/pressures_of_body.hpp>
#include <pliant/body/state_of_body.hpp>
