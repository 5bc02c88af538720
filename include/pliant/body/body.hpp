#pragma once

#include <pliant/body/archive.hpp>
#include <pliant/body/embedding.hpp>
#include <pliant/body/groups.hpp>
#include <pliant/body/set_state.hpp>
#include <pliant/constraint/press.hpp>
#include <pliant/constraint/reactions.hpp>
#include <pliant/force/connected_term.hpp>
#include <pliant/mesh/check.hpp>
#include <pliant/topology/compose.hpp>

namespace pliant {

/// How Body::drive moves nodes.
struct DriveOptions {
  DirectionMask directions = 0;  // bit k: direction k; 0: all
  std::string name{};  // under which a saved state finds the motion again; "" makes one up
};

/// A deformable body: nodes, elements in groups of formulations, conditions and loads, on one backend
/// in one precision. It can be moved from, not copied. Everything a user hands in or reads is in the user's
/// own order of nodes and elements. Integrators (solver/) advance its state.
template <Backend B, class M, class... Fs>
class Body {
 public:
  using backend_type = B;
  using scalar = typename B::scalar;
  using mesh_type = M;
  using parts_type = Parts<B, M, Fs...>;
  using layout_type = typename parts_type::layout_type;
  using state_type = typename parts_type::state_type;
  static constexpr int dim = M::dim;
  static constexpr bool has_internal_variables = parts_type::has_internal_variables;
  using Points = std::vector<Point<dim>>;
  using Facets = std::vector<Facet<dim>>;

  /// Starts at rest, undeformed; all elements of a type are in the first group given for that type. Throws
  /// Error for an unsound mesh (mesh/check.hpp), and for a material, parameters of laws and values per
  /// element that are impossible or that the precision cannot hold.
  Body(B backend, M mesh, Elastic const& material, Group<Fs>... groups)
      : parts_(first_parts(std::move(backend), std::move(mesh), material.checked(),
                           std::tuple(std::move(groups)...))) {}

  // What it is made of, and where it is.
  B const& backend() const { return parts_->backend; }
  Elastic const& material() const { return parts_->material; }
  M const& mesh() const { return parts_->state.topology->mesh(); }
  Index nodes() const { return parts_->layout.nodes(); }
  state_type const& state() const { return parts_->state; }
  double time() const { return parts_->state.time; }  // s
  std::int64_t steps() const { return parts_->state.steps; }
  /// For integrators, solvers and adaptation.
  parts_type& parts() { return *parts_; }
  parts_type const& parts() const { return *parts_; }

  // Its elements' groups.
  /// The group of each element, as the number among the groups given for its type.
  template <Element E>
  std::vector<Tag> groups_of() const {
    return user_groups<E>(*parts_);
  }
  /// Puts elements into the group of a formulation. Throws Error for a number that no element has.
  template <class F>
  void assign(std::vector<Index> const& elements) {
    assign_group<F>(*parts_, elements);
  }

  // What holds and pulls it. Throw Error for nodes and facets that the mesh has not, for conditions that
  // contradict each other, and for numbers that are not finite.
  /// Holds all directions where they are now; velocities become zero.
  Handle clamp(Facets const& facets) { return hold(facets, all_directions<dim>); }
  Handle clamp(std::vector<Index> const& nodes) { return hold(nodes, all_directions<dim>); }
  /// Holds directions (bit k: direction k) where they are now.
  Handle hold(Facets const& facets, DirectionMask directions) {
    return add_condition(*parts_, {{}, facets, {}, directions, {}, {}});
  }
  Handle hold(std::vector<Index> const& nodes, DirectionMask directions) {
    return add_condition(*parts_, {{}, {}, nodes, directions, {}, {}});
  }
  /// Moves nodes: their displacement is motion(time) or motion(place at rest, time), m.
  Handle drive(Facets const& facets, Motion<dim> motion, DriveOptions options = {}) {
    return add_condition(*parts_, driven(facets, {}, std::move(motion), std::move(options)));
  }
  Handle drive(std::vector<Index> const& nodes, Motion<dim> motion, DriveOptions options = {}) {
    return add_condition(*parts_, driven({}, nodes, std::move(motion), std::move(options)));
  }
  /// A pressure that follows the surface, Pa, positive against the outward normal, on facets of the
  /// boundary told by their corners, from either side. Pressing the same facets again, in whatever order, replaces it.
  Handle press(Facets const& facets, double pascals) {
    return pliant::press(*parts_, facets, pascals);
  }
  /// Ends a condition or a pressure. Throws Error for a handle that names neither.
  void release(Handle handle) { pliant::release(*parts_, handle); }
  /// The forces that a condition exerts, N, at each of its nodes in ascending order, without the inertia of
  /// driven nodes. Throws Error for a handle of no condition.
  Points reactions(Handle handle) { return pliant::reactions(*parts_, handle); }
  /// Adds a force term of the user's own: a physics on sets of nodes, which stays with them when the mesh
  /// changes (see ConnectedTerm). The stable step knows its stiffness at the moment it is asked.
  template <template <class> class Physics, std::size_t Nodes>
  void add(std::vector<std::array<Index, Nodes>> sets, Physics<double> const& physics) {
    static_assert(NodalPhysics<Physics<double>>,
                  "a physics for body.add has energy(rest, u) or force(rest, u)");
    static_assert(Physics<double>::dim == dim, "a physics for body.add has the body's dimension");
    static_assert(Physics<double>::nodes == int{Nodes},
                  "each set has as many nodes as the physics");
    check_sets(sets);
    add([sets = std::move(sets), physics, origin = parts_->layout.middle](
            B const& b, NodeRows const& rows) -> std::unique_ptr<AnyForceTerm<B, dim>> {
      auto own = sets;
      for (auto& set : own)
        for (Index& node : set) node = rows.of_node[static_cast<std::size_t>(node)];
      return std::make_unique<ConnectedTerm<B, Physics>>(b, std::move(own), physics, rows.count(),
                                                         origin);
    });
  }
  /// Any other: `make`(backend, rows) is called again when the rows of nodes change; when it throws, that change is not made.
  void add(typename parts_type::MakeTerm make) { add_term(*parts_, std::move(make)); }
  /// m/s². Integrators and solvers say on which masses it acts.
  void set_gravity(Point<dim> const& g) { pliant::set_gravity(*parts_, g); }
  /// A force −c m v at each node; c in 1/s, not negative.
  void set_damping(double per_mass) { pliant::set_damping(*parts_, per_mass); }
  /// The force on one node, N, constant in direction. Does not wait, and only the first call allocates, but for a
  /// node that hangs between others or whose patch sleeps.
  void set_load(Index node, Point<dim> const& force) { pliant::set_load(*parts_, node, force); }
  /// The forces on all nodes, (nodes, dim), N; see mesh/loads.hpp.
  void set_loads(Points const& forces) { pliant::set_loads(*parts_, forces); }

  // Its motion: (nodes, dim), m and m/s. Setters throw Error for another number of nodes and for numbers that are
  // not finite in the body's precision; slaves follow their masters, and held directions have no velocity.
  Points displacements() const { return parts_->layout.in_user_order(parts_->state.u); }
  Points velocities() {
    synchronize_velocities(*parts_);
    return parts_->layout.in_user_order(parts_->state.v);
  }
  void set_displacements(Points const& u) { pliant::set_displacements(*parts_, u); }
  void set_velocities(Points const& v) { pliant::set_velocities(*parts_, v); }
  /// (nodes, dim), N: internal forces −∂W/∂u of the present displacements, pressures and the user's force
  /// terms, without gravity and loads; those of slaves are with their masters.
  Points forces() {
    evaluate_all_forces(*parts_);
    parts_->layout.interpolation.clear(parts_->backend, parts_->f());
    return parts_->layout.in_user_order(parts_->layout.f);
  }

  /// Writes the state to a binary stream; nothing changes. Throws Error where the stream fails. User's force
  /// terms, listeners and limits are not in it, motions by their names alone.
  template <class Stream>
  void save(Stream& stream) const {
    save_state(stream, *parts_);
  }
  /// Takes the state that a body made alike (mesh, material, groups, scalar; any backend) wrote; the next
  /// integrator goes on as if nothing had happened. This body has been given the motions of driven nodes
  /// under the same names, and its force terms. Listeners are not called. Throws Error, with the body as
  /// it was, for a wrong body, another version, damage, truncation, a missing motion, and a force term that cannot be
  /// made anew.
  template <class Stream>
  void load(Stream& stream) {
    detail::check_nobody_is_told(*parts_, "load");
    load_state(stream, *parts_);
  }

  // For a simulator that owns its state: arrays in the backend's memory, node i at [stride i], which
  // are added to and never overwritten. Laws with internal variables need the time `dt` since they were
  // committed, s. Error where a stride is smaller than the dimension, or `dt` is missing or negative.
  /// f += −∂W/∂u, N, pressures and the user's force terms included.
  void add_force(scalar const* u, scalar* f, int stride = dim, double dt = unset) {
    pliant::add_force(*parts_, u, f, stride, dt);
  }
  /// f += factor · ∂F/∂u · du of the same forces F, at the displacement u.
  void add_tangent_product(scalar const* u, scalar const* du, scalar* f, double factor = 1,
                           int stride = dim, double dt = unset) {
    pliant::add_tangent_product(*parts_, u, du, f, factor, stride, dt);
  }
  /// Strain energy and that of force terms that have one, J.
  double energy(scalar const* u, int stride = dim) { return energy_of(*parts_, u, stride); }
  /// (nodes), kg; those of slaves are with their masters.
  void add_lumped_mass(scalar* m) const { pliant::add_lumped_mass(*parts_, m); }
  /// Brings internal variables up to displacements u, after a step of size dt, s.
  void commit(scalar const* u, double dt, int stride = dim) {
    pliant::commit(*parts_, u, dt, stride);
  }
  /// Calls listener(TopologyChange) after each change of the mesh. What it throws leaves refine or the
  /// Adaptation, with the body changed all the same. Where a mesh is changed in a GPU's memory, the host plans each change, too,
  /// for those who listen. Throws Error, as another change and load do, where a listener asks for it that is told of a
  /// change.
  void on_change(std::function<void(TopologyChange<M> const&)> listener) {
    detail::check_nobody_is_told(*parts_, "on_change");
    parts_->listeners.push_back(std::move(listener));
  }
  /// The same for who keeps values of nodes or elements in the backend's memory, or has to know of changes only: calls
  /// listener(BackendChange), behind those listeners. The host plans nothing for these.
  void on_backend_change(std::function<void(BackendChange<M, B> const&)> listener) {
    detail::check_nobody_is_told(*parts_, "on_backend_change");
    parts_->backend_listeners.push_back(std::move(listener));
  }

 private:
  static constexpr double unset = detail::unset_step;
  static std::unique_ptr<parts_type> first_parts(B backend, M mesh, Elastic const& material,
                                                 std::tuple<Group<Fs>...> groups) {
    HostThreads const threads(backend, mesh);
    check(mesh);
    auto topology = std::make_shared<Topology<M>>(std::move(mesh));
    topology->element_values = element_values(topology->mesh(), groups, material);
    layout_type layout(backend, *topology, material, groups);
    auto parts = std::unique_ptr<parts_type>(new parts_type{.backend = std::move(backend),
                                                            .material = material,
                                                            .groups = std::move(groups),
                                                            .layout = std::move(layout)});
    parts->first = topology;
    parts->state.topology = std::move(topology);
    parts->state.prescribed = std::make_shared<Prescribed<dim> const>();
    make_arrays(*parts);
    return parts;
  }
  template <Element... Es>
  static std::vector<std::vector<double>> element_values(Mesh<Es...> const& mesh,
                                                         std::tuple<Group<Fs>...> const& groups,
                                                         Elastic const& material) {
    return {detail::element_values_of<scalar, Es>(groups, material, mesh)...};
  }
  template <std::size_t Nodes>
  void check_sets(std::vector<std::array<Index, Nodes>> const& sets) const {
    if (sets.empty())
      throw Error("body.add: there are no sets of nodes; give those that the force term acts on");
    for (auto const& set : sets)
      for (Index node : set)
        if (node < 0 || node >= nodes())
          throw Error("body.add: a force term names node ", node, ", but nodes are numbered 0 to ",
                      nodes() - 1);
  }
  static Condition<dim> driven(Facets facets, std::vector<Index> nodes, Motion<dim> motion,
                               DriveOptions options) {
    if (!motion) throw Error("body.drive: the motion is empty; give a function of time");
    auto const directions = options.directions == 0 ? all_directions<dim> : options.directions;
    return {{},         std::move(facets),       std::move(nodes),
            directions, std::move(options.name), std::move(motion)};
  }

  std::unique_ptr<parts_type> parts_;
};

template <Backend B, class M, class... Gs>
Body(B, M, Elastic, Gs...) -> Body<B, M, typename Gs::formulation...>;

}  // namespace pliant
