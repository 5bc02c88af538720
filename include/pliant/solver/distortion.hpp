#pragma once

#include <pliant/backend/value_at.hpp>
#include <pliant/body/velocities.hpp>
#include <pliant/quadrature/gauss.hpp>

namespace pliant {

namespace detail {

/// ‖F‖² + ‖F⁻¹‖² − 2 d in the middle of each element: 0 at rest and under rotation, large where an element is
/// stretched or flattened.
template <class T, class Laws>
struct DistortionVisitor {
  static constexpr int counters = 1;
  T* values;  // (elements)

  template <int G, class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const& rest, V const& u) const {
    using E = typename Laws::template formulation<G>::element;
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    static constexpr auto table = tabulate<E, Gauss<1>, T>();
    auto const h = RestMap<E, S>::at(Coefficients<E, S>::of(rest), table, 0)
                       .gradient(Coefficients<E, S>::of(u), table, 0);
    auto const c = cofactor_less_identity(h);
    S const j = S(1) + determinant_less_one(h);
    S const squared = dot(h, h) + S(2) * trace(h), inverse = dot(c, c) + S(2) * trace(c);
    // ‖F‖² = d + squared; ‖cof F‖² = d + inverse
    Vector<S, 1> value;
    value[0] = squared + (S(E::dim) + inverse) / (j * j) - S(E::dim);
    return value;
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const& value, Again const&,
                                 Tally const&) const {
    values[e] = value[0];
  }
};

/// m a²/8 of a node, in its free directions.
template <class T, int Dim>
struct AccelerationTerm {
  NodeField<T const, Dim> f;
  T const* mass;
  DirectionMask const* held;
  ExternalForces<T, Dim> external;
  NodeField<T const, Dim> v;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    T const m = mass[i];
    if (!(m > T(0))) return 0;
    double sum = 0;
    for (int k = 0; k < Dim; ++k) {
      if (held[i] >> k & 1) continue;
      T force = f(i, k);
      if (external.load) force += external.load[node_stride * static_cast<std::ptrdiff_t>(i) + k];
      double const a =
          static_cast<double>(force / m + external.gravity[k] - external.damping * v(i, k));
      sum += static_cast<double>(m) * a * a;
    }
    return sum / 8;
  }
};

}  // namespace detail

/// The largest distortion of an element, ‖F‖² + ‖F⁻¹‖² − 2 d in its middle.
template <class Parts>
double largest_distortion(Parts& parts) {
  using T = typename Parts::T;
  double largest = 0;
  parts.for_each_type([&](auto& table, auto&) {
    using Table = std::remove_cvref_t<decltype(table)>;
    if (table.count() == 0) return;
    if (table.scratch.size() == 0)
      table.scratch = zeros<T>(parts.backend, static_cast<std::size_t>(table.count()));
    parts.backend.template visit<Table::groups>(
        table.elements, detail::DistortionVisitor<T, typename Table::Laws>{table.scratch.data()},
        parts.no_counters, parts.rest(), std::as_const(parts).u());
    largest = std::max(
        largest, parts.backend.maximum(table.count(), detail::ValueAt<T>{table.scratch.data()}));
  });
  return largest;
}

/// Σ m a²/8, J/s²: Δt² of it is what the kinetic energy at a time has over that of the half steps around it,
/// v₋·M·v₊/2.
template <class Parts>
double acceleration_term(Parts& parts) {
  using T = typename Parts::T;
  evaluate_forces(parts);
  return parts.backend.sum(parts.layout.nodes,
                           detail::AccelerationTerm<T, Parts::dim>{{parts.layout.f.data()},
                                                                   parts.layout.mass.data(),
                                                                   parts.layout.held.data(),
                                                                   external_forces(parts),
                                                                   std::as_const(parts).v()});
}

}  // namespace pliant
