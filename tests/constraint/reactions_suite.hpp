#pragma once

#include "support/formulations.hpp"

namespace pliant::test::reactions_suite {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Facets = std::vector<Facet<2>>;

template <class TheBody>
void settle(TheBody& body, double damping, double until) {
  body.set_damping(damping);
  CentralDifference step;
  while (body.time() < until) step(body, 64);
  REQUIRE(largest(body.velocities()) < 1e-8);
}

TEST_CASE("the reactions of a clamped column balance its weight and loads", "[constraint]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {0.25, 1}, .cells = {3, 8}});
    for (bool refined : {false, true}) {
      auto body = body_of<Rubber>(backend, mesh);
      auto const foot = body.clamp(mesh.boundary("bottom"));
      body.set_gravity({0.002, -0.01});
      if (refined) refine(body, {{1, 4, 10, 22}});
      REQUIRE(body.mesh().slaves.empty() != refined);
      auto const top = body.mesh().boundary("top");
      body.set_load(top[0][0], {0.003, -0.004});
      body.set_load(top[0][1], {0.001, 0});
      if (refined) {
        body.set_load(body.mesh().slaves[0].node, {0, -0.002});
        body.set_load(0, {0.0625, 0.125});  // held, with no part in the motion
      }
      settle(body, 1, 70);

      auto const forces = body.reactions(foot);

      REQUIRE(forces.size() == nodes_of(body.mesh().boundary("bottom")).size());
      double const mass = total_mass(body), extra = refined ? 1 : 0;
      Point<2> const sum = total(forces);
      CHECK(sum[0] == Approx(-0.002 * mass - 0.004 - 0.0625 * extra).epsilon(1e-6));
      CHECK(sum[1] == Approx(0.01 * mass + 0.004 + 0.002 * extra - 0.125 * extra).epsilon(1e-6));
    }
  });
}

TEST_CASE("the reaction of driven nodes is minus the internal force", "[constraint]") {
  on_each_backend<FewBackends>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
    auto body = body_of<Rubber>(backend, mesh);
    body.clamp(mesh.boundary("left"));
    auto const plate = body.drive(mesh.boundary("right"),
                                  [](double t) {
                                    return Point<2>{0.2 * t, 0.1};
                                  },
                                  {.directions = 1});
    CentralDifference step{{.step = 2e-3}};
    step(body, 50);

    auto const forces = body.reactions(plate);

    auto const f = body.forces();
    auto const nodes = nodes_of(mesh.boundary("right"));
    REQUIRE(forces.size() == nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      CHECK(forces[n][0] == -f[static_cast<std::size_t>(nodes[n])][0]);
      CHECK(forces[n][0] > 0);
      CHECK(forces[n][1] == 0);  // a direction in which it exerts nothing
    }
  });
}

TEST_CASE("all reactions of a body at rest sum up to what pulls at it", "[constraint]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 0.5}, .cells = {8, 4}});
    auto body = body_of<Rubber>(backend, mesh);
    refine(body, {{0, 9, 10, 31}});
    auto const& now = body.mesh();
    REQUIRE_FALSE(now.slaves.empty());
    auto const left = body.clamp(now.boundary("left"));
    auto const right = body.hold(now.boundary("right"), 1);
    auto const spot = body.drive(std::vector<Index>{nodes_of(now.boundary("right")).front()},
                                 [](double t) {
                                   return Point<2>{0, -0.01 * std::min(t, 1.0)};
                                 },
                                 {.directions = 2});
    body.set_gravity({0.01, -0.02});
    auto loads = Random(4).field<2>(static_cast<std::size_t>(body.nodes()), 1e-3);
    body.set_loads(loads);
    body.press(now.boundary("top"), 0.01);
    settle(body, 6, 25);

    Point<2> sum = total(loads), pressure{};
    auto const top = nodes_of(now.boundary("top"));
    auto const u = body.displacements();
    // −p times the chord's normal, whatever lies between its ends.
    auto const place = [&](std::size_t i) {
      return Point<2>{now.nodes[i][0] + u[i][0], now.nodes[i][1] + u[i][1]};
    };
    std::size_t first = 0, last = 0;
    for (Index i : top) {
      auto const n = static_cast<std::size_t>(i);
      if (now.nodes[n][0] == 0) first = n;
      if (now.nodes[n][0] == 1) last = n;
    }
    pressure = {0.01 * (place(last)[1] - place(first)[1]),
                -0.01 * (place(last)[0] - place(first)[0])};
    for (std::size_t k = 0; k < 2; ++k)
      sum[k] += pressure[k] + total_mass(body) * body.state().gravity[k];
    Point<2> reaction{};
    for (auto handle : {left, right, spot})
      for (std::size_t k = 0; k < 2; ++k) reaction[k] += total(body.reactions(handle))[k];
    for (std::size_t k = 0; k < 2; ++k) CHECK(reaction[k] == Approx(-sum[k]).margin(1e-8));
    CHECK(std::abs(sum[1]) > 0.01);
  });
}

TEST_CASE("nodes that hang on a held facet give their share to its ends once", "[constraint]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {2, 2}});
    auto body = body_of<Rubber>(backend, mesh);
    auto const seam = body.hold(Facets{{1, 4}, {4, 7}}, 3);  // between the left and right cells
    refine(body, {{0, 2}});
    REQUIRE(body.mesh().slaves.size() == 2);
    body.set_displacements(Random(2).field<2>(static_cast<std::size_t>(body.nodes()), 0.02));

    auto const reactions = body.reactions(seam);

    auto const nodes = body.state().prescribed->conditions[0].nodes;
    auto const f = body.forces();
    REQUIRE(nodes.size() == 5);
    for (std::size_t n = 0; n < nodes.size(); ++n)
      for (std::size_t k = 0; k < 2; ++k)
        CHECK(reactions[n][k] == -f[static_cast<std::size_t>(nodes[n])][k]);
  });
}

}  // namespace pliant::test::reactions_suite
