#pragma once

#include <pliant/body/motion.hpp>
#include <pliant/body/step_schedule.hpp>
#include <pliant/force/element_kernels.hpp>

// The loops of a macro step with local time steps.
namespace pliant::detail {

/// One weight of all elements, and one of each.
template <class T>
struct SameWeight {
  static constexpr bool reads_elements = false;
  T value;
  template <class Own>
  PLIANT_HOST_DEVICE T operator()(Own const&) const {
    return value;
  }
};
template <class T>
struct OwnWeight {
  static constexpr bool reads_elements = true;
  ElementField<T const, 1> values;
  template <class Own>
  PLIANT_HOST_DEVICE auto operator()(Own const& own) const {
    return own(values)[0];
  }
};

/// Adds weight · force of elements.
template <class Laws, Geometry How, class Weight>
struct ImpulseKernel {
  static constexpr bool reads_elements = Laws::reads_elements || Weight::reads_elements;
  static constexpr bool few_operations = Laws::few_operations;
  static constexpr bool symmetric = Laws::symmetric;
  Laws groups;
  Weight weight;
  template <int G, class First, class... V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, First const& first, V const&... v) const {
    auto const weighted = [factor = weight(first)](auto const& law, auto const& rest,
                                                   auto const& u) PLIANT_INLINE {
      return factor * force<typename Laws::template formulation<G>, How>(law, rest, u);
    };
    if constexpr (reads_elements && !Laws::reads_elements)
      return groups.template apply<G>(weighted, v...);
    else
      return groups.template apply<G>(weighted, first, v...);
  }
};

template <class T>
struct ScaleRows {
  T* data;  // (nodes, 4)
  Index const* nodes;
  T factor;
  PLIANT_HOST_DEVICE void operator()(Index n) const {
    NodeField<T, node_stride> const field{data};
    field.set(nodes[n], factor * field.at(nodes[n]));
  }
};

/// What depends on the rate of a node alone.
template <class T>
struct RateTable {
  T drift[most_step_levels + 1];           // s: its own time step
  T share[most_step_levels + 1];           // of the finest step in it
  HalfKick<T> half[most_step_levels + 1];  // over half of it

  RateTable(double macro_step, int finest, double damping) {
    for (int r = 0; r <= most_step_levels; ++r) {
      double const step = std::ldexp(macro_step, -r);
      drift[r] = static_cast<T>(step);
      share[r] = static_cast<T>(std::ldexp(1.0, r - finest));
      half[r] = HalfKick<T>::over(step / 2, damping);
    }
  }
};

/// Nodes by rate, and what pulls at them: rows of impulses over the finest step.
template <class T, int Dim>
struct MovingNodes {
  Index const* order;
  StepLevel const* rate;  // in this order
  T const* mass;
  DirectionMask const* held;
  ExternalForces<T, Dim> external;
  RateTable<T> rates;

  /// The mean acceleration over a node's own step, in its free directions.
  PLIANT_HOST_DEVICE Vector<T, Dim> acceleration(Index i, int r, Vector<T, Dim> const& impulse,
                                                 T m) const {
    auto a = Vector<T, Dim>::zero();
    T const inverse_mass = T(1) / m;
    for (int k = 0; k < Dim; ++k) {
      if (held[i] >> k & 1) continue;
      T load = T(0);
      if (external.load) load = NodeField<T const, Dim>{external.load}(i, k);
      a[k] = acceleration_in(multiply_add(rates.share[r], impulse[k], load), inverse_mass,
                             external.gravity[k]);
    }
    return a;
  }
};

/// Brings nodes forward by their own steps, as Advance does all by one: the half-kicks of the step that ends
/// and of the one that begins, then u ← u + step v. Impulses are cleared.
template <class T, int Dim>
struct AdvanceByImpulses {
  MovingNodes<T, Dim> nodes;
  NodeField<T, Dim> u, v, impulses;
  bool ends, begins;

  PLIANT_HOST_DEVICE void operator()(Index n) const {
    Index const i = nodes.order[n];
    int const r = nodes.rate[n];
    // Impulses are cleared last: see Advance.
    auto const impulse = impulses.at(i);
    auto velocity = v.at(i), displacement = u.at(i);
    T const m = nodes.mass[i];
    DirectionMask const held = nodes.held[i];
    if (m > T(0)) {  // slaves follow their masters
      auto const a = nodes.acceleration(i, r, impulse, m);
      HalfKick<T> const half = nodes.rates.half[r];
      for (int k = 0; k < Dim; ++k) {
        if (held >> k & 1) continue;
        if (ends) velocity[k] = half(velocity[k], a[k]);
        if (begins) {
          velocity[k] = half(velocity[k], a[k]);
          displacement[k] += nodes.rates.drift[r] * velocity[k];
        }
      }
      v.set(i, velocity);
      u.set(i, displacement);
    }
    impulses.set(i, Vector<T, Dim>::zero());
  }
};

/// The work of mass damping in a half-kick of a node over its own step, J; see DampingWork.
template <class T, int Dim>
struct ImpulseDampingWork {
  MovingNodes<T, Dim> nodes;
  NodeField<T const, Dim> v, impulses;
  bool ends, begins;

  PLIANT_HOST_DEVICE double operator()(Index n) const {
    Index const i = nodes.order[n];
    int const r = nodes.rate[n];
    T const m = nodes.mass[i];
    if (!(m > T(0))) return 0;
    auto const a = nodes.acceleration(i, r, impulses.at(i), m);
    HalfKick<T> const half = nodes.rates.half[r];
    double const time = static_cast<double>(nodes.rates.drift[r]) / 2;
    double work = 0;
    for (int k = 0; k < Dim; ++k) {
      if (nodes.held[i] >> k & 1) continue;
      T speed = v(i, k);
      for (int second = 0; second < 2; ++second) {
        if (!(second ? begins : ends)) continue;
        T const next = half(speed, a[k]);
        double const from = static_cast<double>(speed), to = static_cast<double>(next);
        double const pull = static_cast<double>(a[k]);
        work += static_cast<double>(m) *
                ((to * to - from * from) / 2 - time * pull * (second ? to : from) +
                 (second ? 1 : -1) * time * time * pull * pull / 2);
        speed = next;
      }
    }
    return work;
  }
};

/// m Δv²/2 of a node, J, where Δv is what the half-kick over its own step gives it.
template <class T, int Dim>
struct HalfKickEnergy {
  MovingNodes<T, Dim> nodes;
  NodeField<T const, Dim> impulses;
  PLIANT_HOST_DEVICE double operator()(Index n) const {
    Index const i = nodes.order[n];
    int const r = nodes.rate[n];
    T const m = nodes.mass[i];
    if (!(m > T(0))) return 0;
    auto const a = nodes.acceleration(i, r, impulses.at(i), m);
    double const step = static_cast<double>(nodes.rates.drift[r]);
    return static_cast<double>(m) * static_cast<double>(dot(a, a)) * step * step / 8;
  }
};

}  // namespace pliant::detail
