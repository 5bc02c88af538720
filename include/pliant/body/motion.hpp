#pragma once

#include <cmath>

#include <pliant/backend/field.hpp>
#include <pliant/backend/value_at.hpp>
#include <pliant/constraint/condition.hpp>
#include <pliant/math/functions.hpp>

// The node loops of a moving body.
namespace pliant {

/// What pulls at nodes besides their elements.
template <class T, int Dim>
struct ExternalForces {
  Vector<T, Dim> gravity;  // m/s²
  T const* load;           // (nodes, 4), N; may be null
};

/// One half-kick of a time h under a force per mass a and mass damping c: v ← α v + β a with α = e^(−c h) and
/// β = (1 − α)/c, exact for constant a. The composition kick, drift, kick is second order, and its stable
/// step is not below that without damping, however strong that is.
template <class T>
struct HalfKick {
  T keep, gain;  // α, and β in s

  static HalfKick over(double time, double damping) {
    double const x = damping * time;
    return {static_cast<T>(std::exp(-x)), static_cast<T>(x > 0 ? -std::expm1(-x) / damping : time)};
  }
  PLIANT_HOST_DEVICE T operator()(T v, T a) const { return multiply_add(keep, v, gain * a); }
};

/// The acceleration in one direction of a node that a force pulls. Every kernel that moves nodes or books work
/// has this one and HalfKick, so that they agree to the bit.
template <class T>
PLIANT_HOST_DEVICE T acceleration_in(T force, T inverse_mass, T gravity) {
  return multiply_add(force, inverse_mass, gravity);
}

/// Brings velocities and displacements forward:
///   v ← the half-kick that the last step left pending
///   v ← the first half-kick of this step
///   u ← u + drift v, and the forces of the old u are cleared
/// Directions that are held keep u and have v = 0. `Forces`: a NodeField, or HandedOnForces.
template <class T, int Dim, class Forces = NodeField<T, Dim>>
struct Advance {
  NodeField<T, Dim> u, v;
  Forces f;
  T const* mass;
  DirectionMask const* held;
  ExternalForces<T, Dim> external;
  HalfKick<T> lag, kick;
  T drift;  // s

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    // All is read before the first write, which the compiler must take for one of what is read.
    auto const force = f.at(i);
    auto velocity = v.at(i), displacement = u.at(i);
    T const m = mass[i];
    DirectionMask const mask = held[i];
    auto load = Vector<T, Dim>::zero();
    if (external.load) load = NodeField<T const, Dim>{external.load}.at(i);
    if (m > T(0)) {  // slaves follow their masters
      T const inverse_mass = T(1) / m;
      for (int k = 0; k < Dim; ++k) {
        if (mask >> k & 1) continue;
        T const a = acceleration_in(force[k] + load[k], inverse_mass, external.gravity[k]);
        T const speed = kick(lag(velocity[k], a), a);
        velocity[k] = speed;
        displacement[k] += drift * speed;
      }
      v.set(i, velocity);
      u.set(i, displacement);
    }
    // Behind what waits for the forces: where a GPU writes to them right behind the load, a step of a million Tet4 takes a
    // tenth longer (H200, single precision).
    if (drift != T(0)) f.set(i, Vector<T, Dim>::zero());
  }
};

/// The acceleration of a node of mass m > 0, zero in directions that are held; without `f`, by what is external.
template <class T, int Dim>
PLIANT_HOST_DEVICE Vector<T, Dim> acceleration_of(Index i, NodeField<T const, Dim> f, T m,
                                                  DirectionMask held,
                                                  ExternalForces<T, Dim> const& external) {
  auto a = Vector<T, Dim>::zero();
  T const inverse_mass = T(1) / m;
  for (int k = 0; k < Dim; ++k) {
    if (held >> k & 1) continue;
    T force = f.data ? f(i, k) : T(0);
    if (external.load) force += NodeField<T const, Dim>{external.load}(i, k);
    a[k] = acceleration_in(force, inverse_mass, external.gravity[k]);
  }
  return a;
}

/// The work of mass damping in one half-kick of an Advance, J: what it changes beyond the work of the other
/// forces, m (v'² − v²)/2 − h a·v_half ∓ h² a²/2 of time h, so that it is zero without damping.
template <class T, int Dim>
struct DampingWork {
  NodeField<T const, Dim> v, f;
  T const* mass;
  DirectionMask const* held;
  ExternalForces<T, Dim> external;
  HalfKick<T> lag, kick;
  double time;  // s: of the half-kick that is looked at
  bool first;   // whether that is the lag

  PLIANT_HOST_DEVICE double operator()(Index i) const {
    T const m = mass[i];
    if (!(m > T(0))) return 0;
    auto const a = acceleration_of(i, f, m, held[i], external);
    double work = 0;
    for (int k = 0; k < Dim; ++k) {
      if (held[i] >> k & 1) continue;
      T const start = v(i, k), middle = lag(start, a[k]);
      double const from = static_cast<double>(first ? start : middle);
      double const to = static_cast<double>(first ? middle : kick(middle, a[k]));
      double const pull = static_cast<double>(a[k]);
      double const half = first ? from : to, sign = first ? -1 : 1;
      work += static_cast<double>(m) * ((to * to - from * from) / 2 - time * pull * half +
                                        sign * time * time * pull * pull / 2);
    }
    return detail::zero_if_not_finite(work);
  }
};

/// time · f·v of a node, J.
template <class T, int Dim>
struct WorkRate {
  NodeField<T const, Dim> f, v;
  double time;  // s
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    return detail::zero_if_not_finite(time * static_cast<double>(dot(f.at(i), v.at(i))));
  }
};

/// Takes the speed out of the directions that are held.
template <class T, int Dim>
struct StopHeld {
  NodeField<T, Dim> v;
  DirectionMask const* held;

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    for (int k = 0; k < Dim; ++k)
      if (held[i] >> k & 1) v(i, k) = T(0);
  }
};

/// Sets the rows [0, nodes) of a field to zero.
template <class T>
struct Clear {
  T* data;  // (nodes, 4)
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    NodeField<T, node_stride>{data}.set(i, Vector<T, node_stride>::zero());
  }
};

/// m v²/2 of a node.
template <class T, int Dim>
struct KineticEnergy {
  NodeField<T const, Dim> v;
  T const* mass;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    auto const speed = v.at(i);
    return static_cast<double>(mass[i] * dot(speed, speed) / T(2));
  }
};

/// −(m g + load)·u of a node.
template <class T, int Dim>
struct PotentialEnergy {
  NodeField<T const, Dim> u;
  T const* mass;
  ExternalForces<T, Dim> external;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    double work = 0;
    for (int k = 0; k < Dim; ++k) {
      T force = mass[i] * external.gravity[k];
      if (external.load) force += NodeField<T const, Dim>{external.load}(i, k);
      work += static_cast<double>(force * u(i, k));
    }
    return -work;
  }
};

/// Copies rows of the user's numbering and stride to those of the padded internal one.
template <class T, int Dim>
struct FromUser {
  NodeField<T, Dim> to;
  T const* from;
  int stride;
  Index const* user_node;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto row = Vector<T, Dim>::zero();
    for (int k = 0; k < Dim && user_node[i] >= 0; ++k)
      row[k] = from[static_cast<std::ptrdiff_t>(stride) * user_node[i] + k];
    to.set(i, row);
  }
};
/// Adds rows of the padded internal numbering to those of the user's.
template <class T, int Dim>
struct AddToUser {
  NodeField<T const, Dim> from;
  T* to;
  int stride;
  Index const* user_node;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto const row = from.at(i);
    for (int k = 0; k < Dim && user_node[i] >= 0; ++k)
      to[static_cast<std::ptrdiff_t>(stride) * user_node[i] + k] += row[k];
  }
};

/// Adds masses to those of the user's numbering.
template <class T>
struct AddMass {
  T const* mass;
  T* to;
  Index const* user_node;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    if (user_node[i] >= 0) to[user_node[i]] += mass[i];
  }
};

}  // namespace pliant
