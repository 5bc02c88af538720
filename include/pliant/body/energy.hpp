#pragma once

#include <pliant/body/body.hpp>

// Energies of a body, J.
namespace pliant {

/// Of the elements and of force terms that have an energy; pressures that follow a surface have none.
template <DeformableBody TheBody>
double strain_energy(TheBody const& body) {
  return energy_at(body.parts(), body.parts().u());
}
template <DeformableBody TheBody>
double kinetic_energy(TheBody& body) {
  return kinetic_energy_of(body.parts());
}
/// −(gravity + loads)·u
template <DeformableBody TheBody>
double potential_energy(TheBody& body) {
  return potential_energy_of(body.parts());
}
template <DeformableBody TheBody>
double total_energy(TheBody& body) {
  return total_energy_of(body.parts());
}

}  // namespace pliant
