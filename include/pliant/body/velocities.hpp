#pragma once

#include <pliant/body/internal_variables.hpp>
#include <pliant/body/loads.hpp>

// Velocities that are a half-kick behind the time of a state.
namespace pliant {

/// Velocities and displacements go forward: see Advance.
template <class Parts>
void advance(Parts& parts, double lag, double kick, double drift) {
  using T = typename Parts::T;
  parts.backend.for_each(
      parts.layout.nodes,
      Advance<T, Parts::dim>{parts.u(), parts.v(), parts.f(), parts.layout.mass.data(),
                             parts.layout.held.data(), external_forces(parts), static_cast<T>(lag),
                             static_cast<T>(kick), static_cast<T>(drift)});
  parts.layout.interpolation.apply(parts.backend, parts.v());
  if (drift != 0) {
    parts.layout.interpolation.apply(parts.backend, parts.u());
    parts.forces_current = false;
  }
}

/// Gives velocities the half-kick that the last step left pending, so that they belong to state.time.
template <class Parts>
void synchronize_velocities(Parts& parts) {
  if (parts.state.pending_half_kick == 0) return;
  evaluate_forces(parts);
  advance(parts, parts.state.pending_half_kick, 0, 0);
  parts.state.pending_half_kick = 0;
}

/// Σ m v²/2, J.
template <class Parts>
double kinetic_energy_of(Parts& parts) {
  synchronize_velocities(parts);
  return parts.backend.sum(parts.layout.nodes,
                           KineticEnergy<typename Parts::T, Parts::dim>{std::as_const(parts).v(),
                                                                        parts.layout.mass.data()});
}

/// Strain, kinetic and potential energy, J.
template <class Parts>
double total_energy_of(Parts& parts) {
  return energy_at(std::as_const(parts), std::as_const(parts).u()) + kinetic_energy_of(parts) +
         potential_energy_of(parts);
}

}  // namespace pliant
