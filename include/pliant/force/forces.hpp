#pragma once

#include <pliant/backend/element_sums.hpp>
#include <pliant/body/parts.hpp>

// The sum of a body's force terms.
namespace pliant {

/// visit(term) for the pressures and the user's own terms.
template <class Parts, class Visit>
void for_each_added_term(Parts const& parts, Visit const& visit) {
  for (auto const& term : parts.pressures) visit(*term);
  for (auto const& term : parts.terms) visit(*term);
}
/// The energy of these, J, of those that have one.
template <class Parts>
double energy_of_added_terms(Parts const& parts) {
  double sum = 0;
  for_each_added_term(parts, [&](auto const& term) {
    if (term.has_energy()) sum += term.energy(parts.backend, parts.here());
  });
  return sum;
}
/// visit(term) for the element groups and these.
template <class Parts, class Visit>
void for_each_force_term(Parts const& parts, Visit const& visit) {
  visit(parts.elements());
  for_each_added_term(parts, visit);
}

/// f += all internal forces and those of terms at displacements u, N, those of slaves handed on; the
/// slaves' own rows are left to be cleared.
template <class Parts>
void accumulate_forces(Parts const& parts, typename Parts::ConstField u, typename Parts::Field f) {
  for_each_force_term(parts,
                      [&](auto const& term) { term.add_force(parts.backend, parts.at(u), f); });
  parts.layout.interpolation.add_transpose(parts.backend, f);
}

/// The energy of all force terms that have one, J.
template <class Parts>
double energy_at(Parts const& parts, typename Parts::ConstField u) {
  double sum = 0;
  for_each_force_term(parts,
                      [&](auto const& term) { sum += term.energy(parts.backend, parts.at(u)); });
  return sum;
}

/// Adds that to *to in the backend's memory.
template <class Parts>
void add_energy_at(Parts const& parts, typename Parts::ConstField u, double* to) {
  auto const& backend = parts.backend;
  parts.elements().add_energy(backend, parts.at(u), to);
  for_each_added_term(parts, [&](auto const& term) {
    if (term.has_energy())
      backend.for_each(1, detail::AddValue{to, term.energy(backend, parts.at(u))});
  });
}

/// Sets the rows of all nodes to zero.
template <class Parts>
void clear_rows(Parts const& parts, typename Parts::Field field) {
  parts.backend.for_each(parts.layout.rows, Clear<typename Parts::T>{field.data});
}

/// Forces of the present displacements are no longer right.
template <class Parts>
void forget_forces(Parts& parts) {
  if (!parts.forces_current) return;
  clear_rows(parts, parts.f());
  parts.forces_current = parts.forces_complete = false;
}

/// f += what pulls at nodes that may move, at the present displacements: sleeping patches are passed over, and slaves keep
/// theirs. By the kernels that ElementGroups::add_force takes.
template <class Parts, class KernelOf = TheirOwnKernels>
void accumulate_own_forces(Parts const& parts, typename Parts::Field f,
                           KernelOf const& kernel_of = {}) {
  parts.awake_elements().add_force(parts.backend, parts.here(), f, kernel_of);
  for_each_added_term(parts,
                      [&](auto const& term) { term.add_force(parts.backend, parts.here(), f); });
}
/// The same, those of slaves handed on.
template <class Parts, class KernelOf = TheirOwnKernels>
void accumulate_awake_forces(Parts const& parts, typename Parts::Field f,
                             KernelOf const& kernel_of = {}) {
  accumulate_own_forces(parts, f, kernel_of);
  parts.layout.interpolation.add_transpose(parts.backend, f);
}

/// Brings layout.f up to the present displacements, at nodes that may move.
template <class Parts, class KernelOf = TheirOwnKernels>
void evaluate_forces(Parts& parts, KernelOf const& kernel_of = {}) {
  if (parts.forces_current) return;
  accumulate_awake_forces(std::as_const(parts), parts.f(), kernel_of);
  parts.forces_current = true;
  parts.forces_complete = !parts.awake;
}
/// The same, at all nodes.
template <class Parts>
void evaluate_all_forces(Parts& parts) {
  if (parts.forces_current && parts.forces_complete) return;
  forget_forces(parts);
  accumulate_forces(parts, std::as_const(parts).u(), parts.f());
  parts.forces_current = parts.forces_complete = true;
}

/// Makes layout.f long enough for the scratch rows of all terms. The forces in it are lost.
template <class Parts>
void make_room_for_forces(Parts& parts) {
  Index scratch = 0;
  for_each_force_term(parts,
                      [&](auto const& term) { scratch = std::max(scratch, term.scratch_nodes()); });
  std::size_t const rows = static_cast<std::size_t>(parts.layout.rows + scratch);
  forget_forces(parts);
  if (parts.layout.f.size() < node_stride * rows)
    parts.layout.f = zeros<typename Parts::T>(parts.backend, node_stride * rows);
  parts.scratch.reset();
  parts.schedule.reset();
  ++parts.revision;
}

}  // namespace pliant
