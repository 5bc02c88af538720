#include <pliant/solver/newton.hpp>

#include "support/assembly.hpp"
#include "support/seed_scene.hpp"

// Static equilibria of two other codes on the same meshes (REFERENCES, sections 12a and 12b).
namespace pliant::test::static_test {

template <class F>
void check_beam(Point<2> const& tip) {
  INFO(formulation_name<F>());
  auto body = seed_body<F>(Reference<double>{});

  solve_static(body);

  Point<2> const u = body.displacements()[seed_tip];
  CHECK(std::abs(u[0] - tip[0]) < 1e-10 * std::abs(tip[1]));
  CHECK(std::abs(u[1] - tip[1]) < 1e-10 * std::abs(tip[1]));
}

TEST_CASE("the plane cantilever hangs where it does in two other codes", "[solver]") {
  using Q = Quad4;
  check_beam<Formulation<Tri3, Gauss<1>, SaintVenantKirchhoff>>(
      {-6.276797374995e-02, -3.265342253317e-01});
  check_beam<Formulation<Q, Gauss<2>, SaintVenantKirchhoff>>(
      {-1.448088958555e-01, -4.848352967743e-01});
  check_beam<Formulation<Tri3, Gauss<1>, NeoHookean>>({-6.275264377996e-02, -3.301061587812e-01});
  check_beam<Formulation<Q, Gauss<2>, NeoHookean>>({-1.429046662200e-01, -4.848132827220e-01});
  check_beam<Formulation<Tri3, Gauss<1>, Hooke>>({-3.083888194534e-04, -3.572160797204e-01});
  check_beam<Formulation<Q, Gauss<2>, Hooke>>({0, -5.980259629225e-01});
}

template <class F>
void check_solid(double ux, double uy) {
  INFO(formulation_name<F>());
  // 4 m by 1 m by 1 m, ρ g = 1e4 N/m³; the tip is the middle of the far side.
  auto const mesh = mesh::box<typename F::element>(
      {.size = {4, 1, 1}, .cells = {8, 2, 2}, .origin = {0, -0.5, -0.5}});
  Body body{Reference<double>{}, mesh, Elastic{4e6, 0.3, 1000}, Group<F>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -10, 0});

  solve_static(body);

  std::size_t const tip = (1 * 3 + 1) * 9 + 8;
  CHECK(mesh.nodes[tip] == Point<3>{4, 0, 0});
  CHECK(std::abs(body.displacements()[tip][0] - ux) < 1e-10);
  CHECK(std::abs(body.displacements()[tip][1] - uy) < 1e-10);
}

TEST_CASE("the solid cantilever hangs where it does in two other codes", "[solver]") {
  check_solid<Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>>(-3.927585880596e-02,
                                                                 -5.156697721458e-01);
  check_solid<Formulation<Hex8, Gauss<2>, SaintVenantKirchhoff>>(-9.980319744908e-02,
                                                                 -8.402461146258e-01);
  check_solid<Formulation<Tet4, Gauss<1>, NeoHookean>>(-3.648903947288e-02, -5.266681407493e-01);
  check_solid<Formulation<Hex8, Gauss<2>, NeoHookean>>(-9.255474177735e-02, -8.396319657727e-01);
  check_solid<Formulation<Tet4, Gauss<1>, Hooke>>(-1.859381783573e-03, -5.257843533908e-01);
  check_solid<Formulation<Hex8, Gauss<2>, Hooke>>(0, -8.647050445904e-01);
}

TEST_CASE("inner nodes find their places in a uniform state", "[solver]") {
  auto const mesh = mixed_mesh(6);
  Body body{Reference<double>{}, mesh, soft, Group<Formulation<Quad4, Gauss<2>, NeoHookean>>{},
            Group<Formulation<Tri3, Gauss<1>, NeoHookean>>{}};
  auto const u = uniform(mesh.nodes, Tensor<double, 2>{{{0.2, 0.4}, {0, -0.1}}});
  auto moved = u;
  Random random(1);
  for (Index i : inner_nodes(mesh))
    for (double& x : moved[static_cast<std::size_t>(i)]) x += 0.02 * random();
  body.set_displacements(moved);
  body.clamp(boundary_nodes(mesh));

  solve_static(body);

  CHECK(difference(body.displacements(), u) < 1e-12);
}

TEST_CASE("the assembled matrix is that of the tangent products", "[solver]") {
  auto const mesh = mixed_mesh(4);
  using Quads = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
  using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
  Body body{Reference<double>{},
            mesh,
            soft,
            Group<Quads>{},
            Group<Linear>{},
            Group<Formulation<Tri3, Gauss<1>, NeoHookean>>{}};
  body.assign<Linear>({0, 2});
  auto const u = Random(1).field<2>(mesh.nodes.size(), 0.02);
  auto const values = flat<double>(u);

  auto const assembled = assemble(
      body,
      Eigen::Map<Eigen::VectorXd const>(values.data(), static_cast<Eigen::Index>(values.size())));

  Eigen::MatrixXd const k = assembled_stiffness(body, u);
  CHECK((Eigen::MatrixXd(assembled.stiffness) - k).norm() < 1e-14 * k.norm());
  auto const f = flat<double>(forces_at(body, u));
  CHECK((assembled.force -
         Eigen::Map<Eigen::VectorXd const>(f.data(), static_cast<Eigen::Index>(f.size())))
            .norm() < 1e-14);
  CHECK(assembled.energy == Approx(strain_energy(body)).epsilon(1e-14));
}

TEST_CASE("a body that nothing holds has no static solution", "[solver]") {
  auto body = body_of<Formulation<Quad4, Gauss<2>, NeoHookean>>(Reference<double>{},
                                                                regular_mesh<Quad4>(3));
  auto const u = Random(1).field<2>(static_cast<std::size_t>(body.nodes()), 0.01);
  body.set_displacements(u);
  body.set_gravity({0, -1});
  CHECK_THROWS_AS(solve_static(body), Error);
  CHECK(difference(body.displacements(), u) == 0);
}

TEST_CASE("a static solution that does not converge leaves the body as it was", "[solver]") {
  auto body = seed_body<Formulation<Quad4, Gauss<2>, NeoHookean>>(Reference<double>{});
  CHECK_THROWS_WITH(solve_static(body, {.max_iterations = 2}), says("no convergence"));
  CHECK(largest(body.displacements()) == 0);
}

}  // namespace pliant::test::static_test
