#pragma once

#include <pliant/solver/newton.hpp>

#include "support/formulations.hpp"

namespace pliant::test::newton_suite {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

/// A strip of 1 m by 0.25 m, 8 x 2 cells.
inline Mesh<Quad4> strip(int n = 1) {
  return mesh::rectangle({.size = {1, 0.25}, .cells = {8 * n, 2 * n}});
}
inline std::vector<Index> all_nodes(Mesh<Quad4> const& mesh) {
  std::vector<Index> all(mesh.nodes.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
  return all;
}

/// The largest force that nothing balances: at nodes and in directions that are not held.
template <class TheBody>
double imbalance(TheBody& body) {
  auto f = body.forces();
  auto const loads = nodal_loads(body);
  for (std::size_t i = 0; i < f.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      f[i][k] += body.parts().layout.mass_list()[i] * body.state().gravity[k];
      if (!loads.empty()) f[i][k] += loads[i][k];
    }
  for (auto const& condition : body.state().prescribed->conditions)
    for (Index node : condition.nodes)
      for (std::size_t k = 0; k < 2; ++k)
        if (condition.directions >> k & 1) f[static_cast<std::size_t>(node)][k] = 0;
  return largest(f);
}

TEST_CASE("a strip whose end is driven takes the confined stretch", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = strip();
    for (int load_steps : {1, 4}) {
      auto body = body_of<Rubber>(backend, mesh);
      body.hold(all_nodes(mesh), 2);
      body.hold(mesh.boundary("left"), 1);
      body.drive(mesh.boundary("right"),
                 [](double) -> Point<2> {
                   return {0.2, 0};
                 },
                 {.directions = 1});

      auto const report = solve_static(body, {.load_steps = load_steps});

      auto const u = body.displacements();
      for (std::size_t i = 0; i < u.size(); ++i)
        CHECK(u[i][0] == Approx(0.2 * mesh.nodes[i][0]).margin(1e-12));
      double pull = 0;
      auto const f = body.forces();
      for (Index i : nodes_of(mesh.boundary("right"))) pull -= f[static_cast<std::size_t>(i)][0];
      CHECK(pull == Approx(0.25 * 1.18913722532).epsilon(1e-11));  // REFERENCES, section 6
      CHECK(report.unknowns == 7 * 3);
      CHECK(report.energy == Approx(strain_energy(body)).epsilon(1e-12));
    }
  });
}

TEST_CASE("an end that is driven far arrives in load steps", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = strip();
    auto body = body_of<Rubber>(backend, mesh);
    body.hold(all_nodes(mesh), 2);
    body.hold(mesh.boundary("left"), 1);
    // More than a cell: alone, it would turn the last cells inside out.
    body.drive(mesh.boundary("right"),
               [](double) -> Point<2> {
                 return {-0.3, 0};
               },
               {.directions = 1});

    solve_static(body, {.load_steps = 10});

    auto const u = body.displacements();
    for (std::size_t i = 0; i < u.size(); ++i)
      CHECK(u[i][0] == Approx(-0.3 * mesh.nodes[i][0]).margin(1e-12));
  });
}

TEST_CASE("the load does work twice the energy that a linear body stores", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = body_of<Linear>(backend, strip());
    body.clamp(body.mesh().boundary("left"));
    body.set_load(26, {0.02, -0.01});
    body.set_load(13, {0, 0.03});

    auto const report = solve_static(body);

    auto const u = body.displacements();
    double const work = 0.02 * u[26][0] - 0.01 * u[26][1] + 0.03 * u[13][1];
    CHECK(work == Approx(2 * report.energy).epsilon(1e-10));
    CHECK(report.energy > 1e-4);
    CHECK(report.iterations == 1);
    CHECK(imbalance(body) < 1e-13);
  });
}

TEST_CASE("load steps lead to the same equilibrium", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const solved = [&](int load_steps) {
      auto body = body_of<Rubber>(backend, strip());
      body.clamp(body.mesh().boundary("left"));
      body.set_gravity({0, -0.05});
      body.set_load(26, {0.002, 0});
      auto const report = solve_static(body, {.load_steps = load_steps});
      CHECK(imbalance(body) < 1e-12);
      CHECK(report.iterations >= load_steps);
      return body.displacements();
    };

    auto const at_once = solved(1);

    CHECK(difference(solved(5), at_once) < 1e-9 * largest(at_once));
    CHECK(largest(at_once) > 0.1);
  });
}

TEST_CASE("a static solution leaves velocities and time alone", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = body_of<Rubber>(backend, strip());
    body.clamp(body.mesh().boundary("left"));
    body.set_gravity({0, -0.05});
    CentralDifference step{{.step = 1e-3}};
    step(body, 10);
    auto const v = body.velocities();

    solve_static(body);

    CHECK(difference(body.velocities(), v) == 0);
    CHECK(body.time() == Approx(0.01));
    CHECK(body.steps() == 10);
    CHECK(imbalance(body) < 1e-12);
  });
}

TEST_CASE("bodies in single precision find the same equilibrium", "[solver]") {
  on_each_backend<Backends<float>>([]<class B>(B const& backend) {
    auto const solved = [](auto const& on) {
      auto body = body_of<Rubber>(on, strip());
      body.clamp(body.mesh().boundary("left"));
      body.set_gravity({0, -0.05});
      body.drive(body.mesh().boundary("right"), [](double) -> Point<2> { return {0.1, 0.05}; });
      solve_static(body);
      return body.displacements();
    };

    auto const exact = solved(Reference<double>{});

    // Newton's method runs in double precision; the result, and what is driven, are rounded.
    CHECK(difference(solved(backend), exact) < 1e-7 * largest(exact));
  });
}

TEST_CASE("a body that is not held enough has no static solution", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    for (bool in_balance : {false, true}) {
      INFO((in_balance ? "loads in balance" : "gravity"));
      auto body = body_of<Rubber>(backend, strip());
      body.hold(body.mesh().boundary("left"), 1);  // slides along y
      if (in_balance) {
        body.set_load(4, {0, 0.001});
        body.set_load(22, {0, -0.001});
      } else {
        body.set_gravity({0, -1});
      }
      auto const u = body.displacements();

      CHECK_THROWS_AS(solve_static(body), Error);

      CHECK(difference(body.displacements(), u) == 0);
    }
  });
}

TEST_CASE("options of the static solver that make no sense are refused", "[solver]") {
  auto body = body_of<Rubber>(Reference<double>{}, strip());
  body.clamp(body.mesh().boundary("left"));
  CHECK_THROWS_AS(solve_static(body, {.load_steps = 0}), Error);
  CHECK_THROWS_AS(solve_static(body, {.max_iterations = 0}), Error);
  CHECK_THROWS_AS(solve_static(body, {.tolerance = 0}), Error);
  CHECK_THROWS_AS(solve_static(body, {.tolerance = NAN}), Error);
}

}  // namespace pliant::test::newton_suite
