#pragma once

#include <pliant/body/velocities.hpp>

namespace pliant {

namespace detail {

/// m a²/8 of a node, in its free directions.
template <class T, int Dim>
struct AccelerationTerm {
  NodeField<T const, Dim> f;  // may have no data: of gravity and loads alone
  T const* mass;
  DirectionMask const* held;
  ExternalForces<T, Dim> external;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    T const m = mass[i];
    if (!(m > T(0))) return 0;
    double sum = 0;
    for (int k = 0; k < Dim; ++k) {
      if (held[i] >> k & 1) continue;
      T force = f.data ? f(i, k) : T(0);
      if (external.load) force += external.load[node_stride * static_cast<std::ptrdiff_t>(i) + k];
      double const a = static_cast<double>(force / m + external.gravity[k]);
      sum += static_cast<double>(m) * a * a;
    }
    return sum / 8;
  }
};

template <class Parts>
double acceleration_term_of(Parts& parts, typename Parts::ConstField f) {
  return parts.backend.sum(
      parts.layout.nodes,
      AccelerationTerm<typename Parts::T, Parts::dim>{
          f, parts.layout.mass.data(), parts.layout.held.data(), external_forces(parts)});
}

}  // namespace detail

/// Σ m a²/8, J/s²: Δt² of it is what the kinetic energy at a time has over that of the half steps around it,
/// v₋·M·v₊/2.
template <class Parts>
double acceleration_term(Parts& parts) {
  evaluate_forces(parts);
  return detail::acceleration_term_of(parts, {parts.layout.f.data()});
}

/// The same of gravity and loads alone.
template <class Parts>
double load_term(Parts& parts) {
  return detail::acceleration_term_of(parts, {nullptr});
}

/// The total energy, and what the one that leapfrog keeps has less: that has the kinetic energy v₋·M·v₊/2 of the
/// half steps around the present time, v∓ = v ∓ Δt/2 a. For linear laws it is constant to rounding,
/// whatever the step; beyond the stable one it no longer bounds the motion.
template <class Parts>
WatchedEnergy leapfrog_energy(Parts& parts) {
  double const step = parts.state.integrator.step;
  return {total_energy_of(parts), step * step * acceleration_term(parts)};
}

}  // namespace pliant
