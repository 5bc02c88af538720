#pragma once

#include <cmath>

#include <pliant/backend/element_sums.hpp>
#include <pliant/backend/sums.hpp>
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
    auto const acceleration = acceleration_of(i, f, m, held[i], external);
    double sum = 0;
    for (int k = 0; k < Dim; ++k) {
      double const a = static_cast<double>(acceleration[k]);
      sum += static_cast<double>(m) * a * a;
    }
    return sum / 8;
  }
};

template <class Parts>
AccelerationTerm<typename Parts::T, Parts::dim> acceleration_term_of_nodes(
    Parts& parts, typename Parts::ConstField f) {
  return {f, parts.layout.mass.data(), parts.still(), external_forces(parts)};
}

}  // namespace detail

/// Σ m a²/8, J/s²: Δt² of it is what the kinetic energy at a time has over that of the half steps around it,
/// v₋·M·v₊/2.
template <class Parts>
double acceleration_term(Parts& parts) {
  evaluate_forces(parts);
  return parts.backend.sum(parts.layout.rows,
                           detail::acceleration_term_of_nodes(parts, {parts.layout.f.data()}));
}
/// Adds that to *to in the backend's memory.
template <class Parts>
void add_acceleration_term(Parts& parts, double* to) {
  evaluate_forces(parts);
  parts.backend.add_sum(parts.layout.rows,
                        detail::acceleration_term_of_nodes(parts, {parts.layout.f.data()}), to);
}

/// The same of gravity and loads alone.
template <class Parts>
double load_term(Parts& parts) {
  return parts.backend.sum(parts.layout.rows, detail::acceleration_term_of_nodes(parts, {nullptr}));
}

/// The present energies, and what the one that leapfrog keeps has less than their total: that has the kinetic energy v₋·M·v₊/2 of the
/// half steps around the present time, v∓ = v ∓ Δt/2 a. For linear laws it is constant to rounding,
/// whatever the step; beyond the stable one it no longer bounds the motion.
template <class Parts>
WatchedEnergy leapfrog_energy(Parts& parts) {
  return watched_energy_of(parts, add_acceleration_term<Parts>);
}

/// Adds to what is booked, J. What is not finite is not; see detail::Booked.
template <class Parts>
void book(Parts& parts, Work what, double added) {
  bool const booked = std::isfinite(added);
  parts.backend.for_each(1, detail::AddValue{parts.state.work.data() +
                                                 static_cast<int>(booked ? what : Work::unbooked),
                                             booked ? added : 1.0});
}

/// Calls move(), which moves elements between groups, and books what it adds to the energy that leapfrog keeps
/// beyond what the elements tell, where velocities are those of the present time: −Δt² times the change
/// of Σ m a²/8. While a half-kick is pending, the elements tell all, and nothing waits.
template <class Parts, class Move>
void book_switching(Parts& parts, Move const& move) {
  double const step = parts.state.pending_half_kick != 0 ? 0 : parts.state.integrator.step;
  Sums<2, typename Parts::backend_type> sums(parts.backend);
  if (step > 0) add_acceleration_term(parts, sums.data());
  move();
  if (step == 0) return;
  add_acceleration_term(parts, sums.data() + 1);
  auto const [before, after] = sums.read();
  book(parts, Work::switching, -step * step * (after - before));
}

}  // namespace pliant
