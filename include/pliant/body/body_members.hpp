#pragma once

#include <pliant/body/body.hpp>

// The members of Body that are more than a line.
namespace pliant {

// ---- groups ----

template <Backend B, class M, class... Fs>
template <Element E>
std::vector<Tag> Body<B, M, Fs...>::groups_of() const {
  auto const& table = layout_.template table<E>();
  auto const internal = download<Tag>(table.elements.tags());
  std::vector<Tag> tags(internal.size());
  for (std::size_t e = 0; e < tags.size(); ++e)
    tags[static_cast<std::size_t>(table.user_element[e])] = internal[e];
  return tags;
}

template <Backend B, class M, class... Fs>
template <class F>
void Body<B, M, Fs...>::assign(std::vector<Index> const& elements) {
  using E = typename F::element;
  auto& table = layout_.template table<E>();
  constexpr int group = std::remove_reference_t<decltype(table)>::template group_of<F>;
  static_assert(group < std::remove_reference_t<decltype(table)>::groups,
                "assign<F>: this body has no Group<F>");
  std::vector<Tag> user = groups_of<E>();
  for (Index e : elements) {
    if (e < 0 || e >= table.count())
      throw Error("body.assign: there is no " + std::string(E::name()) + " element " +
                  std::to_string(e) + "; they are numbered 0 to " +
                  std::to_string(table.count() - 1));
    user[static_cast<std::size_t>(e)] = static_cast<Tag>(group);
  }
  synchronize_velocities();
  std::vector<Tag> internal(user.size());
  for (std::size_t e = 0; e < user.size(); ++e)
    internal[e] = user[static_cast<std::size_t>(table.user_element[e])];
  table.elements.tags().upload(internal);
  table.elements.regroup();
  forget_forces();
}

// ---- conditions and loads ----

namespace detail {
template <int Dim>
Point<Dim> position_at(Condition<Dim> const& condition, double time) {
  Point<Dim> const u = condition.motion(time);
  for (double x : u)
    if (!std::isfinite(x))
      throw Error("body.drive: the motion of node " +
                  (condition.nodes.empty() ? "(none)" : std::to_string(condition.nodes[0])) +
                  " is " + text<Dim>(u) + " at time " + std::to_string(time) +
                  " s; it must be finite");
  return u;
}
}  // namespace detail

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::add_condition(Condition<dim> condition) {
  for (Index node : condition.nodes)
    if (node < 0 || node >= nodes())
      throw Error("body: a condition names node " + std::to_string(node) +
                  ", but nodes are numbered 0 to " + std::to_string(nodes() - 1));
  if (history_.tree && !condition.facets.empty())
    throw Error(
        "body: a condition on facets comes after a refinement, and would not be inherited; hold "
        "facets before the first refinement, or nodes");
  if (condition.motion) (void)detail::position_at(condition, time_);
  synchronize_velocities();
  conditions_.push_back(std::move(condition));
  upload_conditions();
  stop_held();
  prescribe(time_, 0);
  forget_forces();
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::stop_held() {
  Field const v{layout_.v.data()};
  backend_.for_each(nodes(), StopHeld<T, dim>{v, layout_.held.data()});
  layout_.slaves.interpolate(backend_, v);
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::upload_conditions() {
  std::vector<DirectionMask> held(static_cast<std::size_t>(nodes()), 0);
  motions_.clear();
  for (std::size_t c = 0; c < conditions_.size(); ++c) {
    std::vector<Index> internal;
    for (Index node : conditions_[c].nodes) {
      internal.push_back(layout_.internal_of(node));
      held[static_cast<std::size_t>(internal.back())] |= conditions_[c].directions;
    }
    if (conditions_[c].motion) motions_.push_back({upload(backend_, internal), c});
  }
  layout_.held.upload(held);
  ++revision_;
}

template <Backend B, class M, class... Fs>
bool Body<B, M, Fs...>::has_motions() const {
  return !motions_.empty();
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::prescribe(double time, double over) {
  for (auto const& [list, index] : motions_) {
    Condition<dim> const& condition = conditions_[index];
    Point<dim> const to = detail::position_at(condition, time);
    Point<dim> const from = over > 0 ? detail::position_at(condition, time - over) : to;
    Vector<T, dim> displacement, velocity;
    for (int k = 0; k < dim; ++k) {
      auto const i = static_cast<std::size_t>(k);
      displacement[k] = static_cast<T>(to[i]);
      velocity[k] = over > 0 ? static_cast<T>((to[i] - from[i]) / over) : T(0);
    }
    backend_.for_each(static_cast<Index>(list.size()), Prescribe<T, dim>{displacement_field(),
                                                                         {layout_.v.data()},
                                                                         list.data(),
                                                                         condition.directions,
                                                                         displacement,
                                                                         velocity});
  }
  if (!motions_.empty()) layout_.slaves.interpolate(backend_, displacement_field());
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::set_gravity(Point<dim> const& g) {
  for (double x : g)
    if (!std::isfinite(x))
      throw Error("body.set_gravity: " + detail::text<dim>(g) + " is not finite");
  synchronize_velocities();
  gravity_ = g;
  ++revision_;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::set_damping(double per_mass) {
  if (!(per_mass >= 0 && std::isfinite(per_mass)))
    throw Error("body.set_damping: " + std::to_string(per_mass) +
                " 1/s; give a finite number that is not negative");
  synchronize_velocities();
  damping_ = per_mass;
  ++revision_;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::set_load(Index node, Point<dim> const& force) {
  if (node < 0 || node >= nodes())
    throw Error("body.set_load: there is no node " + std::to_string(node) +
                "; nodes are numbered 0 to " + std::to_string(nodes() - 1));
  for (double x : force)
    if (!std::isfinite(x))
      throw Error("body.set_load: the force at node " + std::to_string(node) + " is not finite");
  synchronize_velocities();
  if (loads_.empty()) loads_.resize(static_cast<std::size_t>(nodes()), Point<dim>{});
  loads_[static_cast<std::size_t>(node)] = force;
  layout_.load = upload(backend_, layout_.padded(loads_));
  ++revision_;
}

template <Backend B, class M, class... Fs>
auto Body<B, M, Fs...>::external_forces() const -> ExternalForces<T, dim> {
  ExternalForces<T, dim> external;
  for (int k = 0; k < dim; ++k)
    external.gravity[k] = static_cast<T>(gravity_[static_cast<std::size_t>(k)]);
  external.damping = static_cast<T>(damping_);
  external.load = layout_.load.size() > 0 ? layout_.load.data() : nullptr;
  return external;
}

// ---- state ----

namespace detail {
template <std::size_t Dim>
void check_field(char const* what, std::vector<std::array<double, Dim>> const& values,
                 Index nodes) {
  if (values.size() != static_cast<std::size_t>(nodes))
    throw Error(std::string(what) + ": got values for " + std::to_string(values.size()) +
                " nodes, but the body has " + std::to_string(nodes));
  for (std::size_t i = 0; i < values.size(); ++i)
    for (double x : values[i])
      if (!std::isfinite(x))
        throw Error(std::string(what) + ": the value at node " + std::to_string(i) +
                    " is not finite");
}
}  // namespace detail

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::set_displacements(std::vector<Point<dim>> const& u) {
  detail::check_field("body.set_displacements", u, nodes());
  synchronize_velocities();
  layout_.u.upload(layout_.padded(u));
  layout_.slaves.interpolate(backend_, displacement_field());
  forget_forces();
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::set_velocities(std::vector<Point<dim>> const& v) {
  detail::check_field("body.set_velocities", v, nodes());
  owed_ = 0;
  layout_.v.upload(layout_.padded(v));
  stop_held();
}

template <Backend B, class M, class... Fs>
auto Body<B, M, Fs...>::velocities() -> std::vector<Point<dim>> {
  synchronize_velocities();
  return layout_.in_user_order(layout_.v);
}

template <Backend B, class M, class... Fs>
auto Body<B, M, Fs...>::forces() -> std::vector<Point<dim>> {
  evaluate_forces();
  return layout_.in_user_order(layout_.f);
}

template <Backend B, class M, class... Fs>
double Body<B, M, Fs...>::energy_at(typename B::template Array<T> const& u) const {
  double total = 0;
  for_each_table([&](auto const& table) {
    using Table = std::remove_cvref_t<decltype(table)>;
    total += backend_.template sum_elements<Table::groups>(
        table.elements, EnergyKernel<typename Table::Laws>{table.laws}, rest_field(),
        ConstField{u.data()});
  });
  return total;
}

template <Backend B, class M, class... Fs>
double Body<B, M, Fs...>::kinetic_energy() {
  synchronize_velocities();
  return backend_.sum(nodes(), KineticEnergy<T, dim>{{layout_.v.data()}, layout_.mass.data()});
}

template <Backend B, class M, class... Fs>
double Body<B, M, Fs...>::potential_energy() const {
  return backend_.sum(nodes(), PotentialEnergy<T, dim>{displacement_field(), layout_.mass.data(),
                                                       external_forces()});
}

// ---- forces and motion ----

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::accumulate_forces(ConstField u, Field f) const {
  for_each_table([&](auto const& table) {
    using Table = std::remove_cvref_t<decltype(table)>;
    backend_.template accumulate<Table::groups>(
        table.elements, ForceKernel<typename Table::Laws>{table.laws}, f, rest_field(), u);
  });
  layout_.slaves.hand_to_masters(backend_, f);
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::evaluate_forces() {
  if (forces_current_) return;
  Field const f{layout_.f.data()};
  clear(f, nodes());
  accumulate_forces(std::as_const(*this).displacement_field(), f);
  forces_current_ = true;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::advance(double lag, double kick, double drift) {
  Field const u = displacement_field(), v{layout_.v.data()};
  backend_.for_each(nodes(), Advance<T, dim>{u,
                                             v,
                                             {layout_.f.data()},
                                             layout_.mass.data(),
                                             layout_.held.data(),
                                             external_forces(),
                                             static_cast<T>(lag),
                                             static_cast<T>(kick),
                                             static_cast<T>(drift)});
  layout_.slaves.interpolate(backend_, v);
  if (drift != 0) {
    layout_.slaves.interpolate(backend_, u);
    forget_forces();
  }
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::synchronize_velocities() {
  if (owed_ == 0) return;
  evaluate_forces();
  advance(owed_, 0, 0);
  owed_ = 0;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::replace(layout_type layout, std::vector<Condition<dim>> conditions,
                                std::vector<Point<dim>> loads,
                                std::shared_ptr<Hierarchy const> tree,
                                std::vector<typename History<dim>::Totals> totals) {
  layout_ = std::move(layout);
  history_.tree = std::move(tree);
  history_.totals = std::move(totals);
  history_.born = steps_;
  conditions_ = std::move(conditions);
  loads_ = std::move(loads);
  if (!loads_.empty()) layout_.load = upload(backend_, layout_.padded(loads_));
  upload_conditions();
  scratch_.reset();
  checkpoint_.reset();
  recorded_.reset();
  owed_ = 0;
  forget_forces();
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::step(double dt, int steps) {
  if (steps > 0 && (owed_ != dt / 2 || has_motions() || forces_current_)) {  // not like the others
    evaluate_forces();
    advance(owed_, dt / 2, dt);
    owed_ = dt / 2;
    time_ += dt;
    ++steps_;
    prescribe(time_, dt);
    return step(dt, steps - 1);
  }
  if (steps == 0) return;
  if (!recorded_ || recorded_->body != this || recorded_->dt != dt ||
      recorded_->revision != revision_)
    recorded_ = RecordedStep{backend_.record([this, dt] {
                               Field const f{layout_.f.data()};
                               clear(f, nodes());
                               accumulate_forces(std::as_const(*this).displacement_field(), f);
                               advance(dt / 2, dt / 2, dt);
                             }),
                             this, dt, revision_};
  recorded_->recording.replay(steps);
  time_ += steps * dt;
  steps_ += steps;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::checkpoint() {
  synchronize_velocities();
  if (!checkpoint_) {
    using A = typename B::template Array<T>;
    checkpoint_ = Checkpoint{A(layout_.u.size()), A(layout_.v.size()), 0, 0};
  }
  auto const count = static_cast<Index>(layout_.u.size());
  backend_.for_each(count, Copy<T>{layout_.u.data(), checkpoint_->u.data()});
  backend_.for_each(count, Copy<T>{layout_.v.data(), checkpoint_->v.data()});
  checkpoint_->time = time_;
  checkpoint_->steps = steps_;
}

template <Backend B, class M, class... Fs>
bool Body<B, M, Fs...>::restore() {
  if (!checkpoint_) return false;
  auto const count = static_cast<Index>(layout_.u.size());
  backend_.for_each(count, Copy<T>{checkpoint_->u.data(), layout_.u.data()});
  backend_.for_each(count, Copy<T>{checkpoint_->v.data(), layout_.v.data()});
  time_ = checkpoint_->time;
  steps_ = checkpoint_->steps;
  owed_ = 0;
  forget_forces();
  return true;
}

// ---- for a simulator that owns its state ----

template <Backend B, class M, class... Fs>
auto Body<B, M, Fs...>::scratch() -> Scratch& {
  if (!scratch_) {
    using A = typename B::template Array<T>;
    scratch_ = Scratch{A(layout_.u.size()), A(layout_.u.size()), A(layout_.f.size())};
  }
  return *scratch_;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::add_force(T const* u, T* f, int stride) {
  Scratch& s = scratch();
  Field const own_u{s.u.data()}, own_f{s.f.data()};
  Index const* order = layout_.user_node_array.data();
  backend_.for_each(nodes(), FromUser<T, dim>{own_u, u, stride, order});
  layout_.slaves.interpolate(backend_, own_u);
  clear(own_f, nodes());
  accumulate_forces({own_u.data}, own_f);
  backend_.for_each(nodes(), AddToUser<T, dim>{{own_f.data}, f, stride, order});
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::add_tangent_product(T const* u, T const* du, T* f, double factor,
                                            int stride) {
  Scratch& s = scratch();
  Field const own_u{s.u.data()}, own_du{s.du.data()}, own_f{s.f.data()};
  Index const* order = layout_.user_node_array.data();
  backend_.for_each(nodes(), FromUser<T, dim>{own_u, u, stride, order});
  backend_.for_each(nodes(), FromUser<T, dim>{own_du, du, stride, order});
  layout_.slaves.interpolate(backend_, own_u);
  layout_.slaves.interpolate(backend_, own_du);
  clear(own_f, nodes());
  for_each_table([&](auto const& table) {
    using Table = std::remove_cvref_t<decltype(table)>;
    backend_.template accumulate<Table::groups>(
        table.elements, TangentKernel<T, typename Table::Laws>{table.laws, static_cast<T>(factor)},
        own_f, rest_field(), ConstField{own_u.data}, ConstField{own_du.data});
  });
  layout_.slaves.hand_to_masters(backend_, own_f);
  backend_.for_each(nodes(), AddToUser<T, dim>{{own_f.data}, f, stride, order});
}

template <Backend B, class M, class... Fs>
double Body<B, M, Fs...>::energy(T const* u, int stride) {
  Scratch& s = scratch();
  Field const own_u{s.u.data()};
  backend_.for_each(nodes(), FromUser<T, dim>{own_u, u, stride, layout_.user_node_array.data()});
  layout_.slaves.interpolate(backend_, own_u);
  return energy_at(s.u);
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::add_lumped_mass(T* m) const {
  backend_.for_each(nodes(), AddMass<T>{layout_.mass.data(), m, layout_.user_node_array.data()});
}

}  // namespace pliant
