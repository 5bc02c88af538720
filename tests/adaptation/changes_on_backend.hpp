#pragma once

#include "adaptation/two_bodies.hpp"
#include "topology/tree_states.hpp"

// Checks of bodies that their backend changes, beside bodies that the host changes.
namespace pliant::test::two_bodies {

/// Refines both, and goes on.
template <class F, class B>
void check_rounds(B const& backend, Index cells, std::size_t one_in, int rounds) {
  TwoBodies<F, B> both(backend, cells);
  for (int round = 0; round < rounds; ++round) {
    both.refine_one_in(one_in);
    if (round % 2 == 0) both.check_all();  // at times the host waits for two
  }
  CHECK(!both.body.mesh().slaves.empty());
  both.check_all();
  double const dt = 0.1 * stable_step(both.host);
  CentralDifference step({.step = dt}), other({.step = dt});
  step(both.body, 5);
  other(both.host, 5);
  CHECK(largest_difference(both.body.displacements(), both.host.displacements()) <
        1000 * both.rounding);
}

/// Refines and coarsens both, in the end back to the first mesh.
template <class F, class B>
void check_both_ways(B const& backend, Index cells, std::size_t one_in, int rounds) {
  TwoBodies<F, B> both(backend, cells);
  auto const first = both.body.mesh();
  auto const masses = both.body.parts().layout.own_masses();
  auto const conditions = *both.body.state().prescribed;
  std::size_t merged = 0;
  for (int round = 0; round < rounds; ++round) {
    both.refine_one_in(one_in);
    both.refine_one_in(one_in);
    both.displace();
    merged += both.coarsen_all_but_one_in(12);
    both.check_all();
    merged += both.coarsen_all_but_one_in(9);
    both.refine_one_in(one_in);
    if (round % 2 == 1) both.check_all();
  }
  CHECK(merged > static_cast<std::size_t>(4 * rounds));
  while (both.coarsen_all_but_one_in(1u << 20) > 0) {  // all but one
  }
  auto coarsen_rest = [](auto& body) {
    for (std::size_t now = 1; now > 0;) {
      std::vector<Index> all(at(count(body)));
      for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
      now = coarsen(body, {all}).merged;
    }
  };
  coarsen_rest(both.body);
  coarsen_rest(both.host);
  both.check_place();
  both.check_all();
  CHECK(both.body.mesh().nodes == first.nodes);
  CHECK(both.body.mesh().tables == first.tables);
  CHECK(both.body.mesh().boundaries == first.boundaries);
  CHECK(both.body.parts().layout.own_masses() == masses);
  for (std::size_t c = 0; c < conditions.conditions.size(); ++c)
    CHECK(both.body.state().prescribed->conditions[c].nodes == conditions.conditions[c].nodes);
}

/// Brings a mesh over to the host after some changes, and after more, beside a body that the host changes.
template <class F, class B>
void check_brought_over(B const& backend, Index cells, std::size_t one_in, int rounds) {
  constexpr int dim = F::element::dim;
  TwoBodies<F, B> both(backend, cells);
  for (int round = 0; round < rounds; ++round) {
    both.refine_one_in(one_in);
    // Nobody has asked for this one when the mesh has changed again.
    auto const earlier = both.body.state().topology;
    auto const wanted_then = both.host.state().topology.shared();
    both.refine_one_in(one_in);
    if (round > 0) CHECK(both.coarsen_all_but_one_in(9) > 0);
    if (round == 1) CHECK(earlier->mesh().tables == wanted_then->mesh().tables);
    REQUIRE(is_on_backend(both.body));
    auto& on = *both.body.parts().topology_on;
    auto const brought = detail::brought_over(on);
    REQUIRE(brought);
    auto const& wanted = *both.host.state().topology;
    auto const& topology = *brought->topology;
    CHECK(listed(topology.tree->tree().cells()) == listed(wanted.tree->tree().cells()));
    CHECK(listed(topology.tree->tree().edges()) == listed(wanted.tree->tree().edges()));
    CHECK(listed(topology.tree->tree().sides()) == listed(wanted.tree->tree().sides()));
    CHECK(listed(topology.tree->tree().lists().rows) == listed(wanted.tree->tree().lists().rows));
    CHECK(topology.tree->leaf_count() == wanted.tree->leaf_count());
    CHECK(topology.tree->points() == wanted.tree->points());
    CHECK(topology.mesh().tables == wanted.mesh().tables);
    CHECK(std::ranges::equal(topology.interpolation.slaves(), wanted.interpolation.slaves(),
                             [](auto const& one, auto const& other) {
                               return one.node == other.node &&
                                      std::ranges::equal(one.masters, other.masters);
                             }));
    auto divided = wanted.tree->tree().divided();
    std::ranges::sort(divided);
    CHECK(topology.tree->tree().divided() == divided);
    CHECK(topology.boundaries().size() == wanted.boundaries().size());
    for (auto const& [name, facets] : wanted.boundaries())
      CHECK(in_any_order<dim>(*topology.boundaries().at(name)) == in_any_order<dim>(*facets));
    auto const& conditions = both.host.state().prescribed->conditions;
    REQUIRE(brought->prescribed->conditions.size() == conditions.size());
    for (std::size_t c = 0; c < conditions.size(); ++c) {
      auto const& own = brought->prescribed->conditions[c];
      CHECK(in_any_order<dim>(own.facets) == in_any_order<dim>(conditions[c].facets));
      CHECK(own.nodes == conditions[c].nodes);
    }
    if (round % 2 == 1) on.set_on_host(*brought);
  }
  both.check_all();
}

template <int Dim>
Point<Dim> drawn(double time) {
  Point<Dim> u{};
  u[0] = 0.3 * time;
  u[Dim - 1] = -0.1 * time * time;
  return u;
}
template <int Dim>
Point<Dim> turned(Point<Dim> const& x, double time) {
  Point<Dim> u{};
  u[0] = 0.1 * time * x[1];
  u[1] = -0.1 * time * x[0];
  return u;
}

/// Holds, presses and drives a body at the sides of a mesh, and sets it in motion; gives the displacements.
template <class TheBody, class M>
auto set_in_motion(TheBody& body, M const& mesh) {
  constexpr int dim = TheBody::dim;
  std::vector<Point<dim>> u(mesh.nodes.size()), v(u);
  for (std::size_t i = 0; i < u.size(); ++i)
    for (std::size_t k = 0; k < dim; ++k) {
      u[i][k] = 0.05 * mesh.nodes[i][(k + 1) % dim] * mesh.nodes[i][k];
      v[i][k] = std::cos(2 * mesh.nodes[i][(k + 1) % dim]) - mesh.nodes[i][k];
    }
  body.hold(mesh.boundary("left"), 2);
  body.press(mesh.boundary("top"), 0.2);
  body.drive(mesh.boundary("bottom"), drawn<dim>, {.directions = 1});
  body.set_displacements(u);
  body.set_velocities(v);
  return u;
}

/// Refines, coarsens and steps both. set_up(body).
template <class F, class B, class SetUp>
void check_changes(B const& backend, Index cells, std::size_t one_in, SetUp const& set_up) {
  TwoBodies<F, B> both(backend, cells, false);
  set_up(both.body);
  set_up(both.host);
  double const dt = 0.05 * stable_step(both.host);
  CentralDifference steps({.step = dt}), of_host({.step = dt});
  auto const step_both = [&] {
    steps(both.body, 3);
    of_host(both.host, 3);
    CHECK(largest_difference(both.body.displacements(), both.host.displacements()) <
          1000 * both.rounding);
    auto const work = external_work(both.body), wanted = external_work(both.host);
    CHECK(work.motions == Approx(wanted.motions).margin(1000 * both.rounding));
    CHECK(work.pressures == Approx(wanted.pressures).margin(1000 * both.rounding));
  };
  std::size_t merged = 0;
  for (int round = 0; round < 2; ++round) {
    both.refine_one_in(one_in);
    both.refine_one_in(one_in);
    step_both();
    merged += both.coarsen_all_but_one_in(12);
    step_both();
  }
  CHECK(merged > 4);
  CHECK(both.body.parts().pressures.size() == both.host.parts().pressures.size());
  CHECK(both.body.parts().driven.size() == both.host.parts().driven.size());
}

}  // namespace pliant::test::two_bodies
