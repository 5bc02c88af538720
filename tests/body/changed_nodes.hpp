#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <pliant/adaptation/family_momentum.hpp>
#include <pliant/body/lumped_masses.hpp>
#include <pliant/topology/topology.hpp>

#include "support/at.hpp"

// What the host makes of the nodes of a mesh that changes: their masses and momentum.
namespace pliant::test::changed_nodes {

inline constexpr double density = 1.3;

/// What give_momentum_back looks at of a body's layout.
struct MassesOnHost {
  std::vector<detail::ExactSum> own;
  detail::SumUnit mass_unit;
  std::vector<double> kilograms;
  std::vector<detail::ExactSum> const& own_masses() const { return own; }
  std::vector<double> const& mass_list() const { return kilograms; }
};
template <class M>
MassesOnHost masses_on_host(Topology<M> const& topology) {
  MassesOnHost masses{{}, detail::unit_of_masses(density, 1), {}};
  masses.own = detail::lumped_masses(topology.mesh(), density, masses.mass_unit);
  for (auto const& sum : masses.own) masses.kilograms.push_back(masses.mass_unit.value_of(sum));
  topology.interpolation.hand_masses(
      [&](Index i, int) -> double& { return masses.kilograms[at(i)]; }, 1);
  return masses;
}
/// No element that stays.
struct NoneStays {
  template <Element E>
  std::vector<Index> of() const {
    return {};
  }
};

/// Values at all nodes.
template <int Dim>
detail::ValuesAt<Point<Dim>> at_all(detail::NodeSubset const& all,
                                    std::vector<Point<Dim>> const& values) {
  detail::ValuesAt<Point<Dim>> list(all);
  std::ranges::copy(values, list.values.begin());
  return list;
}
inline detail::NodeSubset all_nodes(Index count) {
  std::vector<Index> all(at(count));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
  return {all, all.size()};
}
template <int Dim>
Point<Dim> momentum_of(std::vector<double> const& kilograms, std::vector<Point<Dim>> const& v) {
  Point<Dim> sum{};
  for (std::size_t i = 0; i < v.size(); ++i)
    for (std::size_t k = 0; k < Dim; ++k) sum[k] += kilograms[i] * v[i][k];
  return sum;
}

}  // namespace pliant::test::changed_nodes
