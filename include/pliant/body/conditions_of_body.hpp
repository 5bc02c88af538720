#pragma once

#include <pliant/body/body.hpp>
#include <pliant/body/state_of_body.hpp>

// Members of Body: what holds and pulls it.
namespace pliant {

namespace detail {
template <int Dim>
Point<Dim> position_at(Condition<Dim> const& condition, double time) {
  Point<Dim> const u = condition.motion(time);
  for (double x : u)
    if (!std::isfinite(x))
      throw Error(
          "body.drive: the motion of node ",
          condition.nodes.empty() ? MessagePiece("(none)") : MessagePiece(condition.nodes[0]),
          " is ", u, " at time ", time, " s; it must be finite");
  return u;
}
}  // namespace detail

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::add_condition(Condition<dim> condition) {
  for (Index node : condition.nodes)
    if (node < 0 || node >= nodes())
      throw Error("body: a condition names node ", node, ", but nodes are numbered 0 to ",
                  nodes() - 1);
  for (auto const& slave : layout_.slave_list)
    if (std::ranges::find(condition.nodes, slave.node) != condition.nodes.end())
      throw Error("body: node ", slave.node,
                  " hangs between others, whom it follows; hold or drive these instead");
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
  checkpoint_.reset();
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
template <class Change>
void Body<B, M, Fs...>::change_loads(Change const& change) {
  synchronize_velocities();
  double const before = potential_energy();
  change();
  double const added = potential_energy() - before;
  if (std::isfinite(added)) energy_of_new_loads_ += added;
  ++revision_;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::upload_loads() {
  layout_.load = upload(backend_, layout_.padded(loads_));
  Field const load{layout_.load.data()};
  layout_.slaves.hand_to_masters(backend_, load);
  layout_.slaves.clear(backend_, load);
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::set_gravity(Point<dim> const& g) {
  for (double x : g)
    if (!std::isfinite(x)) throw Error("body.set_gravity: ", g, " is not finite");
  change_loads([&] { gravity_ = g; });
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::set_damping(double per_mass) {
  if (!(per_mass >= 0 && std::isfinite(per_mass)))
    throw Error("body.set_damping: ", per_mass, " 1/s; give a finite number that is not negative");
  synchronize_velocities();
  damping_ = per_mass;
  ++revision_;
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::set_load(Index node, Point<dim> const& force) {
  if (node < 0 || node >= nodes())
    throw Error("body.set_load: there is no node ", node, "; nodes are numbered 0 to ",
                nodes() - 1);
  for (double x : force)
    if (!std::isfinite(x)) throw Error("body.set_load: the force at node ", node, " is not finite");
  change_loads([&] {
    if (loads_.empty()) loads_.resize(static_cast<std::size_t>(nodes()), Point<dim>{});
    loads_[static_cast<std::size_t>(node)] = force;
    upload_loads();
  });
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::set_loads(std::vector<Point<dim>> const& forces) {
  detail::check_field("body.set_loads", forces, nodes());
  change_loads([&] {
    loads_ = forces;
    upload_loads();
  });
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

}  // namespace pliant
