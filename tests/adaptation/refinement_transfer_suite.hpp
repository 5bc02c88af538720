#pragma once

#include "adaptation/plane_bodies.hpp"

namespace pliant::test::refinement_transfer_suite {

TEST_CASE("refinement keeps mass and linear momentum", "[adaptation]") {
  on_plane_meshes<AllBackends>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    Random random(3);
    body.set_displacements(random.field<2>(mesh.nodes.size(), 0.02));
    body.set_velocities(random.field<2>(mesh.nodes.size(), 1));
    Point<2> const before = momentum(body);
    int const rounds = 5;

    for (int k = 0; k < rounds; ++k) refine(body, random_marks(body, random, 4));

    // Each round rounds velocities to the body's precision; |v| ≤ 1.
    Point<2> const after = momentum(body);
    double const rounding = rounds * epsilon_of<decltype(body)> * soft.density;
    for (std::size_t k = 0; k < 2; ++k) CHECK(std::abs(after[k] - before[k]) < rounding);
    CHECK(total_mass(body) == Approx(soft.density).epsilon(1e-14));
    CHECK(element_count(body) > 4 * mesh.nodes.size());
    CHECK_FALSE(hanging_nodes(body.mesh())->empty());
  });
}

TEST_CASE("a body that is refined while it moves as one moves on as one", "[adaptation]") {
  on_plane_meshes<AllBackends>(5, []<class B, class M>(B const& backend, M const& mesh) {
    using T = typename B::scalar;
    auto body = plane_body(backend, mesh);
    Point<2> const v{0.3, -0.7};
    body.set_velocities(FieldOf<2>(mesh.nodes.size(), v));
    Random random(3);

    for (int k = 0; k < 5; ++k) refine(body, random_marks(body, random, 4));

    for (auto const& own : body.velocities())
      CHECK(own == Point<2>{static_cast<double>(T(v[0])), static_cast<double>(T(v[1]))});
    CentralDifference step;
    step(body, 20);
    double const rounding = 64 * epsilon_of<decltype(body)>;
    for (auto const& own : body.velocities())
      for (std::size_t k = 0; k < 2; ++k) CHECK(own[k] == Approx(v[k]).margin(rounding));
  });
}

TEST_CASE("refinement leaves the displacement and velocity fields as they were", "[adaptation]") {
  on_plane_meshes<AllBackends>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    Random random(3);
    body.set_displacements(random.field<2>(mesh.nodes.size(), 0.02));
    body.set_velocities(random.field<2>(mesh.nodes.size(), 1));
    auto const u = body.displacements(), v = body.velocities();
    // Where the mean over some nodes is the value of the shape functions.
    std::map<Point<2>, std::vector<Index>> means;
    for_each_element(mesh, [&](auto, std::size_t, auto const& nodes) {
      Point<2> centre{};
      for (std::size_t s = 0; s < nodes.size(); ++s) {
        Index const a = nodes[s], b = nodes[(s + 1) % nodes.size()];
        auto const &x = mesh.nodes[static_cast<std::size_t>(a)],
                   &y = mesh.nodes[static_cast<std::size_t>(b)];
        means[middle(x, y)] = {a, b};
        for (std::size_t k = 0; k < 2; ++k) centre[k] += x[k];
      }
      if (nodes.size() == 4)
        means[{centre[0] / 4, centre[1] / 4}].assign(nodes.begin(), nodes.end());
    });

    auto const report = refine(body, random_marks(body, random, 3));

    auto const new_u = body.displacements(), new_v = body.velocities();
    REQUIRE(new_u.size() == u.size() + report.new_nodes);
    REQUIRE(report.new_nodes > 5);
    double const epsilon = epsilon_of<decltype(body)>;
    // Velocities: the impulse that makes up for the rounding of a family's momentum in double, over
    // masses of a twelfth of the family's and up.
    double const impulse = 32 * std::numeric_limits<double>::epsilon();
    for (std::size_t i = 0; i < new_u.size(); ++i) {
      if (i < u.size()) {
        CHECK(body.mesh().nodes[i] == mesh.nodes[i]);
        CHECK(new_u[i] == u[i]);
        for (std::size_t k = 0; k < 2; ++k)
          CHECK(std::abs(new_v[i][k] - v[i][k]) <= impulse + epsilon / 2);
        continue;
      }
      auto const found = means.find(body.mesh().nodes[i]);
      REQUIRE(found != means.end());
      for (std::size_t k = 0; k < 2; ++k) {
        double at = 0, speed = 0;
        for (Index n : found->second) {
          at += u[static_cast<std::size_t>(n)][k] / static_cast<double>(found->second.size());
          speed += v[static_cast<std::size_t>(n)][k] / static_cast<double>(found->second.size());
        }
        CHECK(std::abs(new_u[i][k] - at) <= 0.02 * epsilon);
        CHECK(std::abs(new_v[i][k] - speed) <= impulse + epsilon);
      }
    }
  });
}

TEST_CASE("refining linear triangles leaves the strain energy alone", "[adaptation]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    auto const mesh = distorted_mesh<Tri3>(5);
    auto body = plane_body(backend, mesh);
    Random random(3);
    body.template assign<TriLinear>({0, 3, 5, 6, 11});
    body.set_displacements(random.field<2>(mesh.nodes.size(), 0.02));
    double const before = strain_energy(body);

    for (int k = 0; k < 4; ++k) refine(body, random_marks(body, random, 4));

    // Displacements are rounded to ε/2 of 0.02, over edges of 0.2/16 and up: a relative error of
    // strains of 0.02 that is random over several hundred elements, twice that of the energy.
    double const epsilon = epsilon_of<decltype(body)>;
    CHECK(strain_energy(body) == Approx(before).epsilon(32 * epsilon));
    for (auto const& entry : ledger(body))
      CHECK(std::abs(entry.strain_energy) < 32 * epsilon * before);
  });
}

TEST_CASE("refining a uniform state leaves the strain energy alone", "[adaptation]") {
  on_plane_meshes<AllBackends>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    body.set_displacements(uniform(mesh.nodes, Tensor<double, 2>{{{0.11, -0.06}, {0.2, -0.07}}}));
    double const before = strain_energy(body);
    Random random(3);

    for (int k = 0; k < 4; ++k) refine(body, random_marks(body, random, 4));

    // Displacements of 0.2 are rounded over edges of 0.2/16, and 800 elements are summed: 31 to 36 ε, by the order of
    // the elements.
    CHECK(strain_energy(body) == Approx(before).epsilon(64 * epsilon_of<decltype(body)>));
    CHECK(before > 0.01);
  });
}

TEST_CASE("the ledger has what refinement did to both energies", "[adaptation]") {
  on_plane_meshes<MainAlone>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    Random random(3);
    body.set_displacements(random.field<2>(mesh.nodes.size(), 0.02));
    body.set_velocities(random.field<2>(mesh.nodes.size(), 1));
    double const energy_at_first = strain_energy(body) + kinetic_energy(body);
    CentralDifference step{{.step = 1e-4}};
    double changes = 0;
    for (int k = 1; k <= 3; ++k) {
      step(body, 3);
      double const strain = strain_energy(body), kinetic = kinetic_energy(body);

      auto const report = refine(body, random_marks(body, random, 4));

      auto const entries = ledger(body);
      REQUIRE(entries.size() == static_cast<std::size_t>(k));
      auto const& entry = entries.back();
      double const rounding = 1e-14 * energy_at_first;
      CHECK(entry.strain_energy == Approx(strain_energy(body) - strain).margin(rounding));
      CHECK(entry.kinetic_energy == Approx(kinetic_energy(body) - kinetic).margin(rounding));
      CHECK(entry.kinetic_energy < -1e-3 * kinetic);  // random speeds are smoothed
      CHECK(entry.elements == static_cast<double>(report.refined));
      CHECK(entry.time == body.time());
      changes += entry.strain_energy + entry.kinetic_energy;
      CHECK(adaptation_energy(body) == Approx(changes));
    }
  });
}

TEST_CASE("refining next to nodes that are held writes down their impulse", "[adaptation]") {
  on_plane_meshes<AllBackends>(5, []<class B, class M>(B const& backend, M const& mesh) {
    auto body = plane_body(backend, mesh);
    body.clamp(mesh.boundary("left"));
    body.hold(mesh.boundary("bottom"), 2);
    body.drive(mesh.boundary("right"),
               [](double t) -> Point<2> {
                 return {0.1 * t, 0.2 * t};
               },
               {.directions = 1});
    Random random(3);
    body.set_velocities(random.field<2>(mesh.nodes.size(), 0.1));
    CentralDifference step{{.step = 1e-3}};
    step(body, 5);
    Point<2> const before = momentum(body);

    for (int k = 0; k < 3; ++k) refine(body, random_marks(body, random, 3));

    Point<2> const after = momentum(body);
    Point<2> taken{};
    for (auto const& entry : ledger(body))
      for (std::size_t k = 0; k < 2; ++k) taken[k] += entry.impulse[k];
    double const rounding = 4 * epsilon_of<decltype(body)> * soft.density;
    for (std::size_t k = 0; k < 2; ++k) CHECK(std::abs(after[k] + taken[k] - before[k]) < rounding);
  });
}

}  // namespace pliant::test::refinement_transfer_suite
