#pragma once

#include <pliant/body/body.hpp>

// Members of Body: displacements, velocities and energies.
namespace pliant {

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::set_displacements(std::vector<Point<dim>> const& u) {
  detail::check_field("body.set_displacements", u, nodes());
  synchronize_velocities();
  layout_.u.upload(layout_.padded(u));
  layout_.slaves.interpolate(backend_, displacement_field());
  checkpoint_.reset();
  forget_forces();
}

template <Backend B, class M, class... Fs>
void Body<B, M, Fs...>::set_velocities(std::vector<Point<dim>> const& v) {
  detail::check_field("body.set_velocities", v, nodes());
  owed_ = 0;
  layout_.v.upload(layout_.padded(v));
  stop_held();
  checkpoint_.reset();
}

template <Backend B, class M, class... Fs>
auto Body<B, M, Fs...>::velocities() -> std::vector<Point<dim>> {
  synchronize_velocities();
  return layout_.in_user_order(layout_.v);
}

template <Backend B, class M, class... Fs>
auto Body<B, M, Fs...>::forces() -> std::vector<Point<dim>> {
  evaluate_forces();
  layout_.slaves.clear(backend_, Field{layout_.f.data()});
  return layout_.in_user_order(layout_.f);
}

template <Backend B, class M, class... Fs>
double Body<B, M, Fs...>::energy_at(typename B::template Array<T> const& u) const {
  double total = 0;
  for_each_table([&](auto const& table) {
    using Table = std::remove_cvref_t<decltype(table)>;
    table.with_geometry([&](auto geometry) {
      total += backend_.template sum_elements<Table::groups>(
          table.elements, EnergyKernel<typename Table::Laws, geometry.value>{table.laws},
          rest_field(), ConstField{u.data()});
    });
  });
  return total;
}

template <Backend B, class M, class... Fs>
double Body<B, M, Fs...>::kinetic_energy() {
  synchronize_velocities();
  return backend_.sum(nodes(), KineticEnergy<T, dim>{{layout_.v.data()}, layout_.mass.data()});
}

template <Backend B, class M, class... Fs>
double Body<B, M, Fs...>::potential_energy() const {
  return backend_.sum(nodes(), PotentialEnergy<T, dim>{displacement_field(), layout_.mass.data(),
                                                       external_forces()});
}

}  // namespace pliant
