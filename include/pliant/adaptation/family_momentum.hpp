#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/body/carried_nodes.hpp>
#include <pliant/body/lumped_masses.hpp>
#include <pliant/body/touched_elements.hpp>
#include <pliant/constraint/condition.hpp>
#include <pliant/formulation/affine.hpp>
#include <pliant/topology/plan.hpp>

namespace pliant::detail {

/// The momentum that an element carries, kg m/s, from velocities at nodes, less that of its mass moving
/// as one at the velocity `base`: where all do, what rounding left is no momentum.
template <Element E>
Point<E::dim> momentum(Connectivity<E> const& nodes, Vector<double, E::nodes> const& volumes,
                       double density, ValuesAt<Point<E::dim>> const& v,
                       Point<E::dim> const& base) {
  Point<E::dim> p{};
  for (std::size_t a = 0; a < E::nodes; ++a)
    for (std::size_t k = 0; k < E::dim; ++k)
      p[k] += density * volumes[static_cast<int>(a)] *
              (v[static_cast<std::size_t>(nodes[a])][k] - base[k]);
  return p;
}

/// A velocity at a node of a family, which has a number among all. Of two pyramids that are split or merged together it is the
/// same: where their base is not plane, volume goes over from one to the other.
template <class M>
Point<M::dim> velocity_in(TouchedElements<M> const& touched,
                          typename Transfer<M::dim>::Family const& family, std::size_t number,
                          ValuesAt<Point<M::dim>> const& v_before,
                          ValuesAt<Point<M::dim>> const& v) {
  bool const shares_base = family.pattern != nullptr && family.pattern->halved_side >= 0;
  bool const is_merged = family.before.size() > 1;
  Point<M::dim> velocity{};
  auto const look_at = [&](FamilyNodes<M> const& families, auto const& velocities) {
    families.visit(number, 0, [&](auto, auto const& nodes) {
      Index const node =
          shares_base ? *std::min_element(nodes.begin(), nodes.begin() + 4) : nodes[0];
      velocity = velocities[static_cast<std::size_t>(node)];
    });
  };
  if (shares_base && is_merged)
    look_at(touched.families_after(), v);
  else
    look_at(touched.families_before(), v_before);
  return velocity;
}

/// What nodes are given, kg m/s, as lists of several threads.
template <int Dim>
using ImpulseList = std::vector<std::pair<Index, Point<Dim>>>;

/// Lists what each node must be given so that a family, which has a number among all, keeps its momentum: the difference that
/// lumping made, shared in proportion to the nodal masses of the elements after the change. `v_before`, `v`: by the numbers
/// of the mesh before and after. `shares`: room that calls after each other share.
template <class M>
void list_family_impulse(TopologyPlan<M> const& plan, TouchedElements<M> const& touched,
                         std::size_t number, double density,
                         ValuesAt<Point<M::dim>> const& v_before, ValuesAt<Point<M::dim>> const& v,
                         std::vector<std::pair<Index, double>>& shares, ImpulseList<M::dim>& list) {
  constexpr std::size_t dim = M::dim;
  Point<dim> const base =
      velocity_in(touched, plan.transfer.families()[number], number, v_before, v);
  Point<dim> lost{};
  touched.families_before().visit_all(number, [&]<Element E>(E, Connectivity<E> const& nodes) {
    auto const p = momentum<E>(nodes, host_nodal_volumes<E>(nodal(*plan.before, nodes)), density,
                               v_before, base);
    for (std::size_t k = 0; k < dim; ++k) lost[k] += p[k];
  });
  double volume = 0;
  shares.clear();  // of nodes, in this volume
  touched.families_after().visit_all(number, [&]<Element E>(E, Connectivity<E> const& nodes) {
    auto const own = host_nodal_volumes<E>(nodal(*plan.after, nodes));
    auto const p = momentum<E>(nodes, own, density, v, base);
    for (std::size_t k = 0; k < dim; ++k) lost[k] -= p[k];
    for (int a = 0; a < E::nodes; ++a) {
      volume += own[a];
      Index const node = nodes[static_cast<std::size_t>(a)];
      auto const known = std::ranges::find(shares, node, &std::pair<Index, double>::first);
      if (known == shares.end())
        shares.emplace_back(node, own[a]);
      else
        known->second += own[a];
    }
  });
  if (lost == Point<dim>{}) return;
  for (auto const& [node, share] : shares) {
    auto& own = list.emplace_back(node, lost).second;
    for (double& x : own) x *= share / volume;
  }
}

/// The impulses of all families, on the threads of the host.
template <class M>
void add_family_impulses(TopologyPlan<M> const& plan, TouchedElements<M> const& touched,
                         double density, ValuesAt<Point<M::dim>> const& v_before,
                         ValuesAt<Point<M::dim>> const& v, ValuesAt<Point<M::dim>>& impulse) {
  constexpr Index few_families = 128;
  HostParts const parts(static_cast<Index>(plan.transfer.families().size()), few_families);
  std::vector<ImpulseList<M::dim>> lists(static_cast<std::size_t>(parts.count()));
  parts([&](Index from, Index to, int part) {
    ImpulseList<M::dim> list;
    std::vector<std::pair<Index, double>> shares;
    for (auto f = static_cast<std::size_t>(from); f < static_cast<std::size_t>(to); ++f)
      list_family_impulse(plan, touched, f, density, v_before, v, shares, list);
    lists[static_cast<std::size_t>(part)] = std::move(list);
  });
  for (auto const& list : lists)  // in the order of families
    for (auto const& [node, own] : list)
      for (std::size_t k = 0; k < M::dim; ++k) impulse[static_cast<std::size_t>(node)][k] += own[k];
}

/// What a node that stays must be given where it begins or ceases to hang, or hangs otherwise: the difference in the velocity
/// at which the mass moves that it has of elements that stay. That is what is left of its own without the shares of those
/// that come.
template <class Layout, class M>
void add_impulse_of_slaves(Transfer<M::dim> const& transfer, TouchedElements<M> const& touched,
                           double density, Layout const& layout,
                           ValuesAt<Point<M::dim>> const& v_before,
                           ValuesAt<Point<M::dim>> const& v, ValuesAt<Point<M::dim>>& impulse) {
  auto const changes = [&](Index node) {
    return node < transfer.staying_nodes() && touched.hangs_otherwise(node);
  };
  std::vector<Index> nodes;
  std::ranges::copy_if(touched.nodes(), std::back_inserter(nodes), changes);
  if (nodes.empty()) return;
  ValuesAt<ExactSum> masses(*v.subset);
  for (Index const node : nodes) {
    auto const i = static_cast<std::size_t>(node);
    masses[i] = layout.own_masses()[i];
  }
  auto const& come = touched.families_after();
  come.visit_all([&]<Element E>(E, Connectivity<E> const& element) {
    if (std::ranges::any_of(element, changes))
      share_mass<E>(come.topology(), element, density, layout.mass_unit,
                    [&](std::size_t node, ExactSum const& share) {
                      if (changes(static_cast<Index>(node))) masses[node] += -share;
                    });
  });
  for (Index const node : nodes) {
    auto const i = static_cast<std::size_t>(node);
    double const mass = layout.mass_unit.value_of(masses[i]);
    auto const &from = v_before[static_cast<std::size_t>(touched.old_number(node))], &to = v[i];
    for (std::size_t k = 0; k < M::dim; ++k) impulse[i][k] += mass * (from[k] - to[k]);
  }
}

/// Gives each family of a change its momentum back by changing velocities; returns what held
/// nodes took of it, N s. Slaves move with their masters, and hand their impulse to them as their mass. `held`:
/// directions, by node.
template <class Layout, class M>
Point<M::dim> give_momentum_back(TopologyPlan<M> const& plan, TouchedElements<M> const& touched,
                                 double density, Layout const& layout,
                                 std::vector<DirectionMask> const& held,
                                 ValuesAt<Point<M::dim>> v_before, ValuesAt<Point<M::dim>>& v) {
  constexpr std::size_t dim = M::dim;
  auto const components = [](ValuesAt<Point<dim>>& field) {
    return [&field](Index i, int k) -> double& {
      return field[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
    };
  };
  auto moving = v;  // with slaves at the velocity of their mass
  plan.before->interpolation.apply_masses(components(v_before), M::dim);
  plan.after->interpolation.apply_masses(components(moving), M::dim);
  ValuesAt<Point<dim>> impulse(*v.subset);
  add_family_impulses(plan, touched, density, v_before, moving, impulse);
  add_impulse_of_slaves(plan.transfer, touched, density, layout, v_before, moving, impulse);
  plan.after->interpolation.hand_masses(components(impulse), M::dim);
  Point<dim> taken{};
  for (Index const node : v.subset->nodes) {
    auto const i = static_cast<std::size_t>(node);
    if (impulse[i] == Point<dim>{}) continue;
    for (std::size_t k = 0; k < dim; ++k)
      if (held[i] >> k & 1)
        taken[k] += impulse[i][k];
      else if (layout.mass_list()[i] > 0)
        v[i][k] += impulse[i][k] / layout.mass_list()[i];
  }
  return taken;
}

}  // namespace pliant::detail
