#pragma once

#include <pliant/backend/value_at.hpp>
#include <pliant/body/parts.hpp>

// Gravity, damping and nodal loads of a body.
namespace pliant {

namespace detail {
/// Sets one row of the loads; what that adds to the energy that is watched is summed where it is: −Δload·u, and
/// −Δt² m (a'² − a²)/8 of what leapfrog keeps, with the node's acceleration before and after. For nodes that are
/// no slaves.
template <class T, int Dim>
struct SetLoad {
  NodeField<T, Dim> load;
  NodeField<T const, Dim> u, f;
  T const* mass;
  DirectionMask const* held;
  ExternalForces<T, Dim> external;  // before
  double step;                      // s; 0: no integrator watches
  Index node;
  Vector<T, Dim> force;
  double* work;  // (Work::count)

  PLIANT_HOST_DEVICE void operator()(Index) const {
    double added = 0;
    for (int k = 0; k < Dim; ++k) {
      double const change = static_cast<double>(force[k]) - static_cast<double>(load(node, k));
      added -= change * static_cast<double>(u(node, k));
      double const m = static_cast<double>(mass[node]);
      if (!(m > 0) || (held[node] >> k & 1)) continue;
      T pull = f(node, k) + mass[node] * external.gravity[k];
      if (external.load) pull += NodeField<T const, Dim>{external.load}(node, k);
      added -= step * step * change * (2 * static_cast<double>(pull) + change) / (8 * m);
    }
    load.set(node, force);
    bool const booked = is_finite(added);
    work[static_cast<int>(booked ? Work::changed_loads : Work::unbooked)] += booked ? added : 1.0;
  }
};
}  // namespace detail

/// What pulls at nodes besides the force terms. Hands loads of slaves to their masters first, where that was
/// not done yet; nothing waits.
template <class Parts>
ExternalForces<typename Parts::T, Parts::dim> external_forces(Parts& parts) {
  using T = typename Parts::T;
  auto& state = parts.state;
  auto& layout = parts.layout;
  ExternalForces<T, Parts::dim> external;
  for (int k = 0; k < Parts::dim; ++k)
    external.gravity[k] = static_cast<T>(state.gravity[static_cast<std::size_t>(k)]);
  external.load = nullptr;
  if (state.load.size() == 0) return external;
  external.load = layout.load.size() > 0 ? layout.load.data() : state.load.data();
  if (!parts.loads_current && layout.load.size() > 0) {
    detail::CopyMember<typename Parts::backend_type>{parts.backend}("", state.load, layout.load);
    layout.interpolation.apply_transpose(parts.backend,
                                         NodeField<T, Parts::dim>{layout.load.data()});
  }
  parts.loads_current = true;
  return external;
}

/// Gives the body an array of loads, all zero, where it has none.
template <class Parts>
void make_loads(Parts& parts) {
  using T = typename Parts::T;
  if (parts.state.load.size() == 0) {
    parts.state.load = zeros<T>(parts.backend, parts.layout.rest.size());
    ++parts.revision;
  }
  if (!parts.layout.interpolation.empty() && parts.layout.load.size() == 0) {
    parts.layout.load = zeros<T>(parts.backend, parts.layout.rest.size());
    ++parts.revision;
  }
  parts.loads_current = false;
}

namespace detail {
template <class Parts>
PotentialEnergy<typename Parts::T, Parts::dim> potential_energy_of_nodes(Parts& parts) {
  return {std::as_const(parts).u(), parts.layout.mass.data(), external_forces(parts)};
}
}  // namespace detail

/// −(gravity + loads)·u, J.
template <class Parts>
double potential_energy_of(Parts& parts) {
  return parts.backend.sum(parts.layout.rows, detail::potential_energy_of_nodes(parts));
}
/// Adds that to *to in the backend's memory.
template <class Parts>
void add_potential_energy(Parts& parts, double* to) {
  parts.backend.add_sum(parts.layout.rows, detail::potential_energy_of_nodes(parts), to);
}

/// The loads of all nodes, N, in the user's order; zero where none was set.
template <class Parts>
std::vector<Point<Parts::dim>> nodal_loads_of(Parts const& parts) {
  if (parts.state.load.size() > 0) return parts.layout.in_user_order(parts.state.load);
  return std::vector<Point<Parts::dim>>(static_cast<std::size_t>(parts.layout.nodes()));
}
/// The same, of a body; empty where none was set.
template <DeformableBody TheBody>
auto nodal_loads(TheBody const& body) {
  auto const& parts = body.parts();
  std::vector<Point<TheBody::dim>> loads;
  if (parts.state.load.size() > 0) loads = nodal_loads_of(parts);
  return loads;
}

}  // namespace pliant
