#pragma once

#include <utility>

#include <pliant/backend/value_at.hpp>
#include <pliant/body/check_field.hpp>
#include <pliant/body/motion.hpp>
#include <pliant/body/velocities.hpp>

// Whether a body's displacements and velocities are finite.
namespace pliant::detail {

/// How large the values of a row are; infinite where one is not finite.
template <class T, int Dim>
struct RowSize {
  NodeField<T const, Dim> field;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    auto const row = field.at(i);
    double most = 0;
    for (int k = 0; k < Dim; ++k)
      most = max(most, infinite_if_not_finite(static_cast<double>(abs(row[k]))));
    return most;
  }
};

/// The larger one of two fields.
template <class T, int Dim>
struct LargerRowSize {
  RowSize<T, Dim> one, other;
  PLIANT_HOST_DEVICE double operator()(Index i) const { return max(one(i), other(i)); }
};

/// The kinetic energy of a node; no number where its displacement is not finite.
template <class T, int Dim>
struct KineticEnergyOfFinite {
  KineticEnergy<T, Dim> energy;
  NodeField<T const, Dim> u;
  PLIANT_HOST_DEVICE double operator()(Index i) const {
    auto const row = u.at(i);
    T nothing = T(0);  // without a branch: 0 times what is not finite is no number
    for (int k = 0; k < Dim; ++k) nothing += T(0) * row[k];
    return energy(i) + static_cast<double>(nothing);
  }
};

/// For a sum over rows of nodes. Velocities have to be of the present time.
template <class Parts>
KineticEnergyOfFinite<typename Parts::T, Parts::dim> kinetic_energy_of_finite_nodes(
    Parts const& parts) {
  return {{parts.v(), parts.layout.mass.data()}, parts.u()};
}

/// Throws Error where a displacement or a velocity is not finite, before a change of the mesh.
template <class Parts>
void check_fields(Parts const& parts) {
  using Size = RowSize<typename Parts::T, Parts::dim>;
  auto const& layout = parts.layout;
  auto const& state = parts.state;
  LargerRowSize<typename Parts::T, Parts::dim> const both{Size{parts.u()}, Size{parts.v()}};
  if (is_finite(parts.backend.maximum(layout.rows, both))) return;
  check_field("change of the mesh (displacements)", layout.in_user_order(state.u), layout.nodes());
  check_field("change of the mesh (velocities)", layout.in_user_order(state.v), layout.nodes());
}

/// Σ m v²/2, J. Throws Error where a displacement or a velocity is not finite, before a change of the mesh.
template <class Parts>
double kinetic_energy_of_finite(Parts& parts) {
  synchronize_velocities(parts);
  double const energy =
      parts.backend.sum(parts.layout.rows, kinetic_energy_of_finite_nodes(std::as_const(parts)));
  if (!is_finite(energy)) check_fields(std::as_const(parts));
  return energy;
}

}  // namespace pliant::detail
