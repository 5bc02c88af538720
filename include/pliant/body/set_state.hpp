#pragma once

#include <pliant/body/check_field.hpp>
#include <pliant/body/checkpoint.hpp>
#include <pliant/constraint/conditions.hpp>

// What a user sets of a body's state. The setters are those of Body, where units and errors are documented.
namespace pliant {

/// The arrays that a state has of elements, at rest, for the present topology, and the tags of these.
template <class Parts>
void make_arrays_of_elements(Parts& parts) {
  parts.for_each_type([&](auto& table, auto& elements) {
    using Table = std::remove_reference_t<decltype(table)>;
    elements.tags = table.elements.take_tags();
    elements.internal_variables =
        zeros<typename Parts::T>(parts.backend, static_cast<std::size_t>(table.count()) *
                                                    Table::Laws::internal_variable_count);
    elements.step_levels = {};
    elements.step_distortions = {};
    if constexpr (Table::Laws::reads_elements)
      table.laws.data = {table.values.data(), elements.internal_variables.data(), table.count()};
  });
}
/// All arrays of a first state, at rest.
template <class Parts>
void make_arrays(Parts& parts) {
  auto& state = parts.state;
  state.u = zeros<typename Parts::T>(parts.backend, parts.layout.rest.size());
  state.v = zeros<typename Parts::T>(parts.backend, parts.layout.rest.size());
  state.work = zeros<double>(parts.backend, static_cast<std::size_t>(Work::count));
  make_arrays_of_elements(parts);
}

namespace detail {
/// Throws Error where a number that was handed in is not finite, in the body's precision too.
template <class T>
void check_number(char const* what, double value) {
  if (!std::isfinite(static_cast<T>(value)))
    throw Error(what, ": ", value,
                std::isfinite(value) ? " is too large for single precision" : " is not finite");
}
template <class T, std::size_t Dim>
Vector<T, int{Dim}> vector_of(std::array<double, Dim> const& x) {
  Vector<T, int{Dim}> v;
  for (std::size_t k = 0; k < Dim; ++k) v[static_cast<int>(k)] = static_cast<T>(x[k]);
  return v;
}
}  // namespace detail

/// Runs a change of loads; what it adds to the energy that is watched, or to the potential one, is booked as
/// their work.
template <class Parts, class Change>
void change_loads(Parts& parts, Change const& change) {
  synchronize_velocities(parts);
  double const potential = parts.add_watched_term ? 0 : potential_energy_of(parts);
  auto const before = present_energy(parts);
  change();
  ++parts.revision;
  parts.state.implicit.balanced = false;
  double const added = parts.add_watched_term ? watched_change(parts, before, present_energy(parts))
                                              : potential_energy_of(parts) - potential;
  if (!std::isfinite(added)) return;
  auto work = download<double>(parts.state.work);
  work[static_cast<std::size_t>(Work::changed_loads)] += added;
  parts.state.work.upload(work);
}

template <class Parts>
void set_gravity(Parts& parts, Point<Parts::dim> const& g) {
  for (double x : g) detail::check_number<typename Parts::T>("body.set_gravity", x);
  if (g != parts.state.gravity) wake_all(parts);
  change_loads(parts, [&] { parts.state.gravity = g; });
}

template <class Parts>
void set_damping(Parts& parts, double per_mass) {
  if (!(per_mass >= 0))
    throw Error("body.set_damping: ", per_mass, " 1/s; give a finite number that is not negative");
  detail::check_number<typename Parts::T>("body.set_damping", per_mass);
  synchronize_velocities(parts);
  parts.state.damping = per_mass;
  parts.state.implicit.balanced = false;
  ++parts.revision;
}

template <class Parts>
void set_loads(Parts& parts, std::vector<Point<Parts::dim>> const& forces) {
  detail::check_field<typename Parts::T>("body.set_loads", forces, parts.layout.nodes());
  if (parts.awake) {  // nodes that are pulled otherwise wake
    auto const before = nodal_loads_of(parts);
    auto const same = [](double a, double b) {
      return static_cast<typename Parts::T>(a) == static_cast<typename Parts::T>(b);
    };
    std::vector<Index> changed;
    for (std::size_t i = 0; i < before.size(); ++i)
      if (!std::ranges::equal(before[i], forces[i], same))
        changed.push_back(parts.layout.internal_of(static_cast<Index>(i)));
    wake_nodes(parts, changed);
  }
  change_loads(parts, [&] {
    make_loads(parts);
    parts.state.load.upload(parts.layout.padded(forces));
  });
}

template <class Parts>
void set_load(Parts& parts, Index node, Point<Parts::dim> const& force) {
  using T = typename Parts::T;
  if (node < 0 || node >= parts.layout.nodes())
    throw Error("body.set_load: there is no node ", node, "; nodes are numbered 0 to ",
                parts.layout.nodes() - 1);
  for (double x : force)
    if (!std::isfinite(static_cast<T>(x)))
      throw Error("body.set_load: the force at node ", node,
                  std::isfinite(x) ? " is too large for single precision" : " is not finite");
  // The loads of slaves pull at several nodes.
  if (parts.state.topology->interpolation.row_of(node)) {
    auto loads = nodal_loads_of(parts);
    loads[static_cast<std::size_t>(node)] = force;
    return set_loads(parts, loads);
  }
  wake_nodes(parts, std::array{parts.layout.internal_of(node)});
  synchronize_velocities(parts);
  make_loads(parts);
  double const step = parts.add_watched_term ? parts.state.integrator.step : 0;
  if (step > 0) evaluate_forces(parts);
  auto const external = external_forces(parts);
  parts.backend.for_each(1, detail::SetLoad<T, Parts::dim>{{parts.state.load.data()},
                                                           std::as_const(parts).u(),
                                                           {parts.layout.f.data()},
                                                           parts.layout.mass.data(),
                                                           parts.still(),
                                                           external,
                                                           step,
                                                           parts.layout.internal_of(node),
                                                           detail::vector_of<T>(force),
                                                           parts.state.work.data()});
  parts.state.implicit.balanced = false;
  parts.loads_current = false;
}

/// Goes back to the last checkpoint with gravity, damping and loads as they are, since it is not the run that
/// changed them. What that adds to the energy there is booked.
template <class Parts>
void roll_back_motion(Parts& parts) {
  detail::CopyMember<typename Parts::backend_type> const copy{parts.backend};
  auto const gravity = parts.state.gravity;
  double const damping = parts.state.damping;
  typename Parts::template Array<typename Parts::T> load;
  copy("loads", parts.state.load, load);
  roll_back(parts);
  parts.state.damping = damping;
  if (gravity == parts.state.gravity && load.size() == 0) return;
  wake_all(parts);
  change_loads(parts, [&] {
    parts.state.gravity = gravity;
    if (load.size() == 0) return;
    make_loads(parts);
    copy("loads", load, parts.state.load);
  });
}

template <class Parts>
void set_displacements(Parts& parts, std::vector<Point<Parts::dim>> const& u) {
  detail::check_field<typename Parts::T>("body.set_displacements", u, parts.layout.nodes());
  change_by_hand(parts, [&] {
    parts.state.u.upload(parts.layout.padded(u));
    parts.layout.interpolation.apply(parts.backend, parts.u());
  });
}

template <class Parts>
void set_velocities(Parts& parts, std::vector<Point<Parts::dim>> const& v) {
  detail::check_field<typename Parts::T>("body.set_velocities", v, parts.layout.nodes());
  change_by_hand(parts, [&] {
    parts.state.v.upload(parts.layout.padded(v));
    stop_held(parts);
  });
}

namespace detail {
template <class Parts>
auto made_term(Parts const& parts, typename Parts::MakeTerm const& make) {
  auto term = make(parts.backend, parts.layout.node_rows());
  if (!term) throw Error("body.add: there is no force term; make one whenever it is asked for");
  return term;
}
}  // namespace detail

/// Adds a force term of the user's own: see Body::add.
template <class Parts>
void add_term(Parts& parts, typename Parts::MakeTerm make) {
  if (!make) throw Error("body.add: the function that makes a force term is empty; give one");
  auto term = detail::made_term(parts, make);
  change_by_hand(parts, [&] {
    parts.terms.push_back(std::move(term));
    parts.term_makers.push_back(std::move(make));
    make_room_for_forces(parts);
  });
}

/// Makes the user's force terms anew, after the numbering changed.
template <class Parts>
void renew_terms(Parts& parts) {
  parts.terms.clear();
  for (auto const& make : parts.term_makers) parts.terms.push_back(detail::made_term(parts, make));
}

}  // namespace pliant
