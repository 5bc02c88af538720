#pragma once

#include <pliant/backend/field.hpp>
#include <pliant/constraint/condition.hpp>

// The node loops of a moving body.
namespace pliant {

/// What pulls at nodes besides their elements.
template <class T, int Dim>
struct ExternalForces {
  Vector<T, Dim> gravity;  // m/s²
  T damping;               // per mass: the force −damping · m v, 1/s
  T const* load;           // (nodes, 4), N; may be null
};

/// Brings velocities and displacements forward:
///   v ← (v + lag a)/(1 + damping lag)       the half kick that the last step left open
///   v ← v (1 − damping kick) + kick a       the first half kick of this step
///   u ← u + drift v                         and the forces of the old u are cleared
/// Both half kicks together are central differences with centred mass damping, whose stable step is
/// that without damping. Directions that are held keep u and have v = 0.
template <class T, int Dim>
struct Advance {
  NodeField<T, Dim> u, v, f;
  T const* mass;
  DirectionMask const* held;
  ExternalForces<T, Dim> external;
  T lag, kick, drift;  // s

  PLIANT_HOST_DEVICE void operator()(Index i) const {
    // All is read before the first write, which the compiler must take for one of what is read.
    auto const force = f.at(i);
    auto velocity = v.at(i), displacement = u.at(i);
    T const m = mass[i];
    DirectionMask const mask = held[i];
    auto load = Vector<T, Dim>::zero();
    if (external.load) load = NodeField<T const, Dim>{external.load}.at(i);
    if (drift != T(0)) f.set(i, Vector<T, Dim>::zero());
    if (!(m > T(0))) return;  // slaves follow their masters; nodes of no element rest
    T const inverse_mass = T(1) / m;
    T const release = T(1) / (T(1) + external.damping * lag);
    for (int k = 0; k < Dim; ++k) {
      if (mask >> k & 1) continue;
      T a = force[k] * inverse_mass + external.gravity[k];
      if (external.load) a += load[k] * inverse_mass;
      T speed = (velocity[k] + lag * a) * release;
      speed = speed * (T(1) - external.damping * kick) + kick * a;
      velocity[k] = speed;
      displacement[k] += drift * speed;
    }
    v.set(i, velocity);
    u.set(i, displacement);
  }
};

/// Puts the nodes of a list at a prescribed displacement and velocity.
template <class T, int Dim>
struct Prescribe {
  NodeField<T, Dim> u, v;
  Index const* nodes;
  DirectionMask directions;
  Vector<T, Dim> displacement, velocity;

  PLIANT_HOST_DEVICE void operator()(Index n) const {
    for (int k = 0; k < Dim; ++k)
      if (directions >> k & 1) {
        u(nodes[n], k) = displacement[k];
        v(nodes[n], k) = velocity[k];
      }
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

template <class T>
struct Copy {
  T const* from;
  T* to;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to[i] = from[i]; }
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
      if (external.load) force += external.load[node_stride * static_cast<std::ptrdiff_t>(i) + k];
      work += static_cast<double>(force * u(i, k));
    }
    return -work;
  }
};

/// Moves rows between the user's numbering and stride and the padded internal one.
template <class T, int Dim>
struct FromUser {
  NodeField<T, Dim> to;
  T const* from;
  int stride;
  Index const* user_node;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    Vector<T, Dim> row;
    for (int k = 0; k < Dim; ++k)
      row[k] = from[static_cast<std::ptrdiff_t>(stride) * user_node[i] + k];
    to.set(i, row);
  }
};
template <class T, int Dim>
struct AddToUser {
  NodeField<T const, Dim> from;
  T* to;
  int stride;
  Index const* user_node;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    auto const row = from.at(i);
    for (int k = 0; k < Dim; ++k)
      to[static_cast<std::ptrdiff_t>(stride) * user_node[i] + k] += row[k];
  }
};

template <class T>
struct AddMass {
  T const* mass;
  T* to;
  Index const* user_node;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to[user_node[i]] += mass[i]; }
};

}  // namespace pliant
