#pragma once

#include <pliant/solver/newton.hpp>

#include "adaptation/plane_bodies.hpp"
#include "support/assembly.hpp"

namespace pliant::test::newton_refined_suite {

template <Element E, class B>
auto cantilever(B const& backend, int n, Put law) {
  auto const mesh = mesh::rectangle<E>({.size = {1, 0.25}, .cells = {8 * n, 2 * n}});
  auto body = plane_body(backend, mesh);
  Marks all(1);
  for (Index e = 0; e < static_cast<Index>(element_count(body)); ++e) all[0].push_back(e);
  put(body, all, law);
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -0.03});
  return body;
}

/// Displacements at the nodes of another mesh, by position.
template <class A, class B>
FieldOf<2> displacements_at(A const& body, B const& mesh) {
  std::map<std::pair<long, long>, std::size_t> at;
  auto const key = [](Point<2> const& p) {
    return std::pair{std::lround(p[0] * 1e6), std::lround(p[1] * 1e6)};
  };
  for (std::size_t i = 0; i < body.mesh().nodes.size(); ++i) at[key(body.mesh().nodes[i])] = i;
  auto const u = body.displacements();
  FieldOf<2> found;
  for (auto const& p : mesh.nodes) found.push_back(u[at.at(key(p))]);
  return found;
}

template <Element E, class B>
void check_uniform(B const& backend, Put law) {
  auto coarse = cantilever<E>(backend, 1, law), fine = cantilever<E>(backend, 2, law);
  Marks all(1);
  for (Index e = 0; e < static_cast<Index>(element_count(coarse)); ++e) all[0].push_back(e);

  refine(coarse, all);
  solve_static(coarse);
  solve_static(fine);

  auto const expected = fine.displacements();
  CHECK(difference(displacements_at(coarse, fine.mesh()), expected) < 1e-9 * largest(expected));
  CHECK(largest(expected) > 0.05);
}

TEST_CASE("a mesh refined everywhere has the equilibrium of the finer mesh", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    check_uniform<Quad4>(backend, Put::rubber);
    check_uniform<Quad4>(backend, Put::linear);
  });
  // Red triangles keep the direction of their diagonals, so that they are those of the finer grid.
  on_each_backend<MainAlone>(
      []<class B>(B const& backend) { check_uniform<Tri3>(backend, Put::rubber); });
}

TEST_CASE("more freedom never raises the potential energy of an equilibrium", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      auto body = cantilever<Tri3>(backend, 1, Put::rubber);
      Random random(seed);
      solve_static(body);
      double last = strain_energy(body) + potential_energy(body);
      for (int k = 0; k < 4; ++k) {
        refine(body, random_marks(body, random, 5));

        solve_static(body);

        double const now = strain_energy(body) + potential_energy(body);
        CHECK(now < last);
        last = now;
        auto const hanging = *hanging_nodes(body.mesh());
        CHECK_FALSE(hanging.empty());
        CHECK(gap(hanging, body.displacements()) < 1e-15);
        auto f = body.forces();
        for (std::size_t i = 0; i < f.size(); ++i)
          f[i][1] -= 0.03 * body.parts().layout.mass_list()[i];
        for (Index i : nodes_of(body.mesh().boundary("left"))) f[static_cast<std::size_t>(i)] = {};
        CHECK(largest(f) < 1e-12);
      }
    }
  });
}

TEST_CASE("the assembled matrix is that of the tangent products with hanging nodes too",
          "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = plane_body(backend, mixed_mesh(3));
    Random random(5);
    for (int k = 0; k < 2; ++k) refine(body, random_marks(body, random, 5));
    put(body, random_marks(body, random, 3), Put::linear);
    auto const n = static_cast<std::size_t>(body.nodes());
    body.set_displacements(random.field<2>(n, 0.01));
    auto const u = body.displacements();
    auto const values = flat<double>(u);

    auto const assembled = assemble(
        body,
        Eigen::Map<Eigen::VectorXd const>(values.data(), static_cast<Eigen::Index>(values.size())));

    Eigen::MatrixXd const k = assembled_stiffness(body, u), own = assembled.stiffness;
    CHECK((own - k).norm() < 1e-13 * k.norm());
    CHECK((own - own.transpose()).norm() < 1e-14 * own.norm());
    auto const f = per_node<2>(std::vector<double>(assembled.force.begin(), assembled.force.end()));
    CHECK(difference(f, body.forces()) < 1e-14);
    CHECK(assembled.energy == Approx(strain_energy(body)).epsilon(1e-13));
  });
}

TEST_CASE("a load at a hanging node pulls at its masters", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const loaded = [&](auto const& load) {
      auto body = cantilever<Quad4>(backend, 1, Put::rubber);
      refine(body, {{5}});
      body.set_gravity({0, 0});
      auto const hanging = *hanging_nodes(body.mesh());
      load(body, hanging[0]);
      return body;
    };
    auto at_node = loaded([](auto& body, Hanging const& h) {
      body.set_load(h.node, {0.004, -0.002});
    });
    auto at_ends = loaded([](auto& body, Hanging const& h) {
      for (Index i : h.side) body.set_load(i, {0.002, -0.001});
    });
    CentralDifference step{{.step = 1e-3}}, other_step{{.step = 1e-3}};

    step(at_node, 20);
    other_step(at_ends, 20);
    CHECK(difference(at_node.displacements(), at_ends.displacements()) < 1e-15);
    CHECK(largest(at_ends.displacements()) > 1e-6);
    CHECK(potential_energy(at_node) == Approx(potential_energy(at_ends)).epsilon(1e-12));
    solve_static(at_node);
    solve_static(at_ends);
    CHECK(difference(at_node.displacements(), at_ends.displacements()) < 1e-12);
    CHECK(largest(at_ends.displacements()) > 1e-3);
    // Once it moves freely, the load is its own.
    Index const node = (*hanging_nodes(at_node.mesh()))[0].node;
    Marks all(1);
    for (Index e = 0; e < static_cast<Index>(element_count(at_node)); ++e) all[0].push_back(e);
    refine(at_node, all);
    CHECK(nodal_loads(at_node)[static_cast<std::size_t>(node)] == Point<2>{0.004, -0.002});
  });
}

TEST_CASE("a hanging node cannot be held or driven", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = cantilever<Quad4>(backend, 1, Put::rubber);
    refine(body, {{5}});
    Index const hanging = (*hanging_nodes(body.mesh()))[0].node;

    CHECK_THROWS_AS(body.clamp(std::vector<Index>{0, hanging}), Error);
    CHECK_THROWS_AS(body.drive(std::vector<Index>{hanging}, [](double) { return Point<2>{}; }),
                    Error);

    CHECK(body.state().prescribed->conditions.size() == 1);
  });
}

}  // namespace pliant::test::newton_refined_suite
