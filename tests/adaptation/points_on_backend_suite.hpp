#pragma once

#include <pliant/law/decorators/viscosity.hpp>

#include "adaptation/two_bodies.hpp"

// What quadrature points keep of bodies whose mesh is changed in their backend's memory, beside bodies that the host changes.
namespace pliant::test::points_on_backend_suite {
using namespace two_bodies;

template <class E, class Q>
using Viscous = Formulation<E, Q, Prony<NeoHookean>::law>;

/// Two bodies that go on from the same state, so that rounding of steps does not add up.
template <class Both>
void step_both(Both& both, double dt) {
  CentralDifference step({.step = dt}), other({.step = dt});
  step(both.body, 3);
  other(both.host, 3);
  auto const u = both.host.displacements(), v = both.host.velocities();
  for (auto* body : {&both.body, &both.host}) {
    body->set_displacements(u);
    body->set_velocities(v);
  }
  auto& parts = both.body.parts();
  auto const& other_parts = both.host.parts();
  auto const rows = std::get<0>(other_parts.layout.tables)
                        .in_user_order(std::get<0>(other_parts.state.elements).internal_variables);
  std::get<0>(parts.state.elements)
      .internal_variables.upload(std::get<0>(parts.layout.tables).in_internal_order(rows));
}

template <class F, class Other = Stiffer<F>, class B>
void check_points(B const& backend, Index cells, std::size_t one_in) {
  TwoBodies<F, B, Other> both(backend, cells);
  double const dt = 0.1 * stable_step(both.host);
  step_both(both, dt);
  for (int round = 0; round < 2; ++round) {
    both.refine_one_in(one_in);
    both.check_all();
    step_both(both, dt);
    both.refine_one_in(one_in);
    // Families of elements of both groups.
    auto const others = some(both.host, 4, both.random), first = some(both.host, 4, both.random);
    for (auto* body : {&both.body, &both.host}) {
      body->template assign<Other>(others);
      body->template assign<F>(first);
    }
    CHECK(both.coarsen_all_but_one_in(9) > 0);
    both.check_all();
    step_both(both, dt);
  }
}

TEST_CASE("quadrature points keep their memory where a body's backend changes its mesh",
          "[adaptation]") {
  on_each_backend<KeepingBackends>([]<class B>(B const& backend) {
    check_points<Viscous<Tri3, Gauss<2>>>(backend, 5, 5);
    check_points<Viscous<Quad4, Gauss<2>>>(backend, 4, 4);
    check_points<Viscous<Tet4, Gauss<1>>>(backend, 2, 8);
    check_points<Viscous<Tet4, Gauss<2>>>(backend, 2, 3);  // children of mirrored ones too
    // The others of the same law, with fewer points.
    check_points<Viscous<Tri3, Gauss<2>>, Viscous<Tri3, Gauss<1>>>(backend, 5, 5);
  });
}

}  // namespace pliant::test::points_on_backend_suite
