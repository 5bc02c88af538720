#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "support/at.hpp"
#include "support/formulations.hpp"
#include "support/keeps_trees.hpp"

// A body whose mesh is changed in its backend's memory, beside one that the host changes.
namespace pliant::test::two_bodies {

template <class F>
using Stiffer = Formulation<typename F::element, typename F::quadrature, Hooke>;

/// A law that keeps something at points.
template <class F>
void make_viscous(Group<F>& group) {
  if constexpr (internal_variables_of<F> > 0)
    group.law = typename F::template law<double>{{3, 2}, {0.5}, {0.1}};
}

/// A body with elements of two groups, displacements and velocities; some nodes are held if it `is_held`. `on_host`: it is refined
/// on the host.
template <class F, class Other = Stiffer<F>, class B>
auto body_of(B const& backend, bool on_host, Index cells, bool is_held = true) {
  using E = typename F::element;
  constexpr int dim = E::dim;
  auto const mesh = distorted_mesh<E>(cells);
  Group<F> group;
  if constexpr (element_values<F> > 0) {
    Random random(5);
    for (std::size_t e = 0; e < std::get<0>(mesh.tables).size(); ++e)
      group.values.push_back({1 + random(), 2 + random()});
  }
  Group<Other> other;
  make_viscous(group);
  make_viscous(other);
  Body body{backend, mesh, soft, group, other};
  std::vector<Point<dim>> u(mesh.nodes.size()), v(u);
  std::vector<Index> held;
  for (std::size_t i = 0; i < u.size(); ++i) {
    auto const& x = mesh.nodes[i];
    for (std::size_t k = 0; k < dim; ++k) {
      u[i][k] = 0.05 * x[(k + 1) % dim] * x[k] + 0.02 * std::sin(3 * x[0]);
      v[i][k] = std::cos(2 * x[(k + 1) % dim]) - x[k];
    }
    if (i % 7 == 0) held.push_back(static_cast<Index>(i));
  }
  if (is_held) {
    body.hold(held, 1);
    body.hold(mesh.boundary("left"), 2);
    body.hold(mesh.boundary("bottom"), 3);
  }
  body.set_displacements(u);
  body.set_velocities(v);
  std::vector<Index> stiff;
  for (Index e = 0; e < static_cast<Index>(std::get<0>(mesh.tables).size()); e += 3)
    stiff.push_back(e);
  body.template assign<Other>(stiff);
  body.set_loads(std::vector<Point<dim>>(mesh.nodes.size(), u[1]));
  if (on_host) change_on_host(body);
  return body;
}

template <class TheBody>
Index count(TheBody const& body) {
  return std::get<0>(body.parts().layout.tables).count();
}
template <class TheBody>
std::vector<Index> some(TheBody const& body, std::size_t one_in, Random& random) {
  std::vector<Index> list;
  for (Index e = 0; e < count(body); ++e)
    if (random.below(one_in) == 0) list.push_back(e);
  if (list.empty()) list.push_back(0);
  return list;
}
template <class TheBody>
bool is_on_backend(TheBody const& body) {
  return body.parts().topology_on != nullptr;
}

template <class Points>
double largest_difference(Points const& a, Points const& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < a[i].size(); ++k)
      most = std::max(most, std::abs(a[i][k] - b[i][k]));
  return most;
}

/// All that the host can ask of two bodies. `rounding`: of the body's precision.
template <class OnBackend, class OnHost>
void check_same(OnBackend& body, OnHost& host, double rounding) {
  auto const &layout = body.parts().layout, &other = host.parts().layout;
  REQUIRE(body.nodes() == host.nodes());
  CHECK(body.mesh().nodes == host.mesh().nodes);
  CHECK(body.mesh().tables == host.mesh().tables);
  auto const &slaves = body.mesh().slaves, &wanted_slaves = host.mesh().slaves;
  REQUIRE(slaves.size() == wanted_slaves.size());
  for (std::size_t s = 0; s < slaves.size(); ++s) {
    CHECK(slaves[s].node == wanted_slaves[s].node);
    CHECK(slaves[s].masters == wanted_slaves[s].masters);
  }
  CHECK(body.mesh().boundaries == host.mesh().boundaries);
  CHECK(layout.own_masses() == other.own_masses());
  CHECK(layout.mass_list() == other.mass_list());
  CHECK(layout.first_of_block == other.first_of_block);
  auto const &conditions = body.state().prescribed->conditions,
             &wanted_conditions = host.state().prescribed->conditions;
  REQUIRE(conditions.size() == wanted_conditions.size());
  for (std::size_t c = 0; c < conditions.size(); ++c) {
    CHECK(conditions[c].nodes == wanted_conditions[c].nodes);
    CHECK(conditions[c].facets == wanted_conditions[c].facets);
  }
  auto const held_in = [](auto const& parts) {
    auto const by_row = download<DirectionMask>(parts.layout.held);
    std::vector<int> by_node;
    for (Index node = 0; node < parts.layout.nodes(); ++node)
      by_node.push_back(by_row[at(parts.layout.internal_of(node))]);
    return by_node;
  };
  CHECK(held_in(body.parts()) == held_in(host.parts()));
  // Of each type: what the host asks of a body's elements.
  auto const of_elements = [](auto& parts) {
    std::vector<std::vector<double>> all;
    parts.for_each_type([&](auto const& table, auto const& elements) {
      using E = typename std::remove_cvref_t<decltype(table)>::element;
      auto const add = [&](auto const& values) { all.emplace_back(values.begin(), values.end()); };
      add(table.user_elements());
      add(table.in_user_order(table.values));
      add(table.in_user_order(elements.internal_variables));
      add(user_groups<E>(std::as_const(parts)));
    });
    return all;
  };
  CHECK(of_elements(body.parts()) == of_elements(host.parts()));
  CHECK(body.displacements() == host.displacements());
  CHECK(largest_difference(body.velocities(), host.velocities()) < 40 * rounding);
  auto const forces = body.forces(), others = host.forces();
  CHECK(largest_difference(forces, others) < 100 * rounding);
  // A device, and some compilers, fuse the products and sums by which nodes that go hand theirs on.
  CHECK(largest_difference(nodal_loads_of(body.parts()), nodal_loads_of(host.parts())) <
        10 * rounding);
  CHECK(kinetic_energy(body) == Approx(kinetic_energy(host)).epsilon(100 * rounding));
  auto const entries = ledger(body), wanted = ledger(host);
  REQUIRE(entries.size() == wanted.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    CHECK(entries[i].action == wanted[i].action);
    CHECK(entries[i].elements == wanted[i].elements);
    CHECK(entries[i].strain_energy == Approx(wanted[i].strain_energy).margin(100 * rounding));
    CHECK(entries[i].kinetic_energy == Approx(wanted[i].kinetic_energy).margin(100 * rounding));
    for (std::size_t k = 0; k < OnHost::dim; ++k)
      CHECK(entries[i].impulse[k] == Approx(wanted[i].impulse[k]).margin(100 * rounding));
  }
}

/// A body whose mesh is changed in its backend's memory, and one that the host changes.
template <class F, class B, class Other = Stiffer<F>>
struct TwoBodies {
  using Element = typename F::element;
  using Body = decltype(body_of<F, Other>(std::declval<B const&>(), false, 2));
  double rounding = std::numeric_limits<typename B::scalar>::epsilon();
  Body body, host;
  Random random{3};

  TwoBodies(B const& backend, Index cells, bool is_held = true)
      : body(body_of<F, Other>(backend, false, cells, is_held)),
        host(body_of<F, Other>(backend, true, cells, is_held)) {}

  void refine_one_in(std::size_t one_in) {
    auto const marked = some(host, one_in, random);
    auto const done = refine(body, {marked}, 3), wanted = refine(host, {marked}, 3);
    CHECK(done.refined == wanted.refined);
    CHECK(done.new_nodes == wanted.new_nodes);
    check_place();
  }
  /// Most, so that some families are merged.
  std::size_t coarsen_all_but_one_in(std::size_t one_in) {
    auto const left = some(host, one_in, random);
    std::vector<Index> marked;
    for (Index e = 0; e < count(host); ++e)
      if (!std::ranges::binary_search(left, e)) marked.push_back(e);
    auto const done = coarsen(body, {marked}), wanted = coarsen(host, {marked});
    CHECK(done.merged == wanted.merged);
    CHECK(done.gone_nodes == wanted.gone_nodes);
    check_place();
    return done.merged;
  }
  /// Some elements to refine, and all others to coarsen.
  MarkedElements refine_one_in_and_coarsen(std::size_t one_in) {
    MarkedElements marked{.refine = {{}}, .coarsen = {{}}};
    for (Index e = 0; e < count(host); ++e)
      (random.below(one_in) == 0 ? marked.refine : marked.coarsen)[0].push_back(e);
    return marked;
  }
  /// Moves all nodes a little, so that those that come to hang are displaced by that.
  void displace() {
    auto u = host.displacements();
    for (auto& of_node : u)
      for (double& x : of_node) x += 1e-3 * (random() - 0.5);
    body.set_displacements(u);
    host.set_displacements(u);
  }
  void check_all() { check_same(body, host, rounding); }
  void check_place() {
    REQUIRE(is_on_backend(body));
    REQUIRE(!is_on_backend(host));
  }
};

}  // namespace pliant::test::two_bodies
