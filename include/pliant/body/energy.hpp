#pragma once

#include <pliant/body/body.hpp>

// Energies of a body, J.
namespace pliant {

/// Of the elements and of force terms that have an energy, J; pressures that follow a surface have none.
template <DeformableBody TheBody>
double strain_energy(TheBody const& body) {
  return energy_at(body.parts(), body.parts().u());
}
/// Σ m v²/2 of the lumped masses at the present time, J.
template <DeformableBody TheBody>
double kinetic_energy(TheBody& body) {
  return kinetic_energy_of(body.parts());
}
/// −Σ (m g + load)·u, J: of gravity and nodal loads, zero at rest positions.
template <DeformableBody TheBody>
double potential_energy(TheBody& body) {
  return potential_energy_of(body.parts());
}
/// The sum of the three, J.
template <DeformableBody TheBody>
double total_energy(TheBody& body) {
  return total_energy_of(body.parts());
}

}  // namespace pliant
