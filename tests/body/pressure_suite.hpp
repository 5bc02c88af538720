#pragma once

#include <pliant/mesh/loads.hpp>
#include <pliant/solver/newton.hpp>

#include "support/difference_quotient.hpp"
#include "support/flat.hpp"
#include "support/formulations.hpp"
#include "support/repeatable.hpp"

namespace pliant::test::pressure_suite {

/// Displacements that turn and stretch, and bend sides that can.
template <class M>
FieldOf<M::dim> turned(M const& mesh) {
  Random random(3);
  return plus(uniform(mesh.nodes, random.tensor<M::dim>(0.5)), 1,
              random.field<M::dim>(mesh.nodes.size(), 0.03));
}

/// Calls visit(backend, F{}) with elements of every kind of side, on the other backend of a CPU with one in the plane and
/// one in space.
template <class Bs, class Visit>
void on_each_side_type(Visit const& visit) {
  on_each_backend<Bs>([&]<class B>(B const& backend) {
    SECTION("Line3") { visit(backend, Formulation<Quad8, Gauss<3>, SaintVenantKirchhoff>{}); }
    SECTION("Quad4") { visit(backend, Formulation<Hex8, Gauss<2>, SaintVenantKirchhoff>{}); }
    if constexpr (runs_all<B>) {
      SECTION("Line2") { visit(backend, Formulation<Tri3, Gauss<1>, SaintVenantKirchhoff>{}); }
      SECTION("Tri3") { visit(backend, Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>{}); }
      SECTION("Tri6") { visit(backend, Formulation<Tet10, Gauss<2>, SaintVenantKirchhoff>{}); }
      SECTION("Quad8") { visit(backend, Formulation<Hex20, Gauss<3>, SaintVenantKirchhoff>{}); }
      SECTION("Quad9") { visit(backend, Formulation<Hex27, Gauss<3>, SaintVenantKirchhoff>{}); }
    }
  });
}

TEST_CASE("a pressure on part of the surface is that of consistent loads at this moment",
          "[body]") {
  on_each_side_type<AllBackends>([]<class B, class F>(B const& backend, F) {
    auto const mesh = distorted_mesh<typename F::element>(4);
    auto const side = mesh.boundary("right");
    auto const u = rounded<typename B::scalar>(turned(mesh));
    auto body = body_of<F>(backend, mesh);
    auto const without = forces_at(body, u);

    body.press(side, 2.5);

    auto const pushed = plus(forces_at(body, u), -1, without);
    auto const expected = pressure_loads(mesh, side, 2.5, u);
    double const rounding = 64 * double{std::numeric_limits<typename B::scalar>::epsilon()};
    CHECK(difference(pushed, expected) < rounding * std::max(largest(expected), largest(without)));
    CHECK(largest(expected) > 0.01);
    body.press(side, 0);
    CHECK(difference(forces_at(body, u), without) <= between_runs(rounding) * largest(without));
  });
}

TEST_CASE("a pressure all around pulls nothing away and turns nothing", "[body]") {
  on_each_side_type<MainAlone>([]<class B, class F>(B const& backend, F) {
    auto const mesh = distorted_mesh<typename F::element>(3);
    auto const u = turned(mesh);
    auto body = body_of<F>(backend, mesh);
    auto const without = forces_at(body, u);
    body.press(mesh::outer_sides(mesh), 1);
    auto const pushed = plus(forces_at(body, u), -1, without);
    double const rounding = 1e-12;
    for (double x : total(pushed)) CHECK(std::abs(x) < rounding);
    for (double x : moment(plus(mesh.nodes, 1, u), pushed)) CHECK(std::abs(x) < rounding);
    CHECK(largest(pushed) > 0.01);
  });
}

TEST_CASE("the tangent of a pressure is the derivative of its force", "[body]") {
  on_each_side_type<MainAlone>([]<class B, class F>(B const& backend, F) {
    auto const mesh = distorted_mesh<typename F::element>(3);
    auto body = body_of<F>(backend, mesh);
    body.press(mesh.boundary("right"), 50);  // far stiffer than the body
    auto const u = uniform(mesh.nodes, Random(1).tensor<F::dim>(0.1));
    auto const along = Random(2).field<F::dim>(u.size(), 1.0);

    auto const product = tangent_product(body, u, along);

    auto const differences = field_derivative<F::dim>(
        [&](double h) { return forces_at(body, plus(u, h, along)); }, 3e-4);
    CHECK(difference(product, differences) < 1e-8 * largest(product));
  });
}

TEST_CASE("a tube under inner pressure holds against Lame's solution", "[body]") {
  // A quarter of a thick tube of radii 1 and 2, plane strain, small pressure.
  using F = Formulation<Quad9, Gauss<3>, SaintVenantKirchhoff>;
  auto mesh = mesh::rectangle<Quad9>({.size = {1, 1}, .cells = {6, 8}});
  for (auto& p : mesh.nodes) {
    double const radius = 1 + p[0], angle = std::acos(-1.0) / 2 * p[1];
    p = {radius * std::cos(angle), radius * std::sin(angle)};
  }
  double const p = 1e-6, nu = 0.3, young = 5.2;
  Body body{MainBackend{}, mesh, soft, Group<F>{}};
  body.hold(mesh.boundary("bottom"), 2);  // along y
  body.hold(mesh.boundary("top"), 1);     // along x
  body.press(mesh.boundary("left"), p);

  solve_static(body);

  // u(r) = (1 + ν)/E · p a²/(b² − a²) ((1 − 2ν) r + b²/r)
  double const expected = (1 + nu) / young * p / 3 * ((1 - 2 * nu) * 1 + 4);
  auto const u = body.displacements();
  for (Index node : nodes_of(mesh.boundary("left"))) {
    auto const i = static_cast<std::size_t>(node);
    CHECK(std::hypot(u[i][0], u[i][1]) == Approx(expected).epsilon(1e-4));
  }
}

TEST_CASE("a pressure in dynamics lifts a plate, step for step on every backend", "[body]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    using F = Formulation<Tri3, Gauss<1>, NeoHookean>;
    auto const run = [](auto const& on) {
      auto const mesh = mesh::rectangle<Tri3>({.size = {1, 0.2}, .cells = {20, 4}});
      auto body = body_of<F>(on, mesh);
      body.clamp(mesh.boundary("left"));
      body.press(mesh.boundary("bottom"), 0.02);
      CentralDifference step;
      while (body.time() < 1) step(body);
      std::vector<Index> marked(20);
      for (Index e = 0; e < 20; ++e) marked[static_cast<std::size_t>(e)] = e;
      refine(body, {marked});
      while (body.time() < 1.5) step(body);
      return body.displacements();
    };
    auto const u = run(backend), expected = run(Reference<double>{});
    CHECK(largest(expected) > 0.05);
    CHECK(difference(u, expected) < 1e-10 * largest(expected));
  });
}

TEST_CASE("facets to press may be told by their corners alone, from either side", "[body]") {
  on_each_side_type<MainAlone>([]<class B, class F>(B const& backend, F) {
    auto const mesh = distorted_mesh<typename F::element>(3);
    auto const side = mesh.boundary("right");
    std::vector<Facet<F::dim>> corners;
    for (auto const& facet : side) {
      auto& reversed = corners.emplace_back();
      for (std::size_t a = facet.corners(); a-- > 0;) reversed.push_back(facet[a]);
    }
    auto body = body_of<F>(backend, mesh);

    body.press(corners, 2.5);
    CHECK(body.state().prescribed->pressures.at(0).facets == side);
    body.press(corners, 1.5);
    body.press(side, 0.5);

    REQUIRE(body.state().prescribed->pressures.size() == 1);
    CHECK(body.state().prescribed->pressures[0].pascals == 0.5);
  });
}

TEST_CASE("pressures that are not finite or nowhere are refused", "[body][errors]") {
  using F = Formulation<Tri3, Gauss<1>, NeoHookean>;
  auto const mesh = mesh::rectangle<Tri3>({.size = {1, 1}, .cells = {2, 2}});
  auto body = body_of<F>(MainBackend{}, mesh);
  CHECK_THROWS_WITH(body.press(mesh.boundary("left"), NAN), says("not finite"));
  CHECK_THROWS_WITH(body.press({Facet<2>{0, 99}}, 1), says("node 99") && says("0 to 8"));
  CHECK_THROWS_WITH(body.press({Facet<2>{0, 1}, Facet<2>{1, 4}}, 1),
                    says("nodes 1 and 4 is not on the boundary of the mesh"));
  CHECK_THROWS_WITH(body.press({Facet<2>{1}}, 1), says("is not on the boundary"));
  CHECK_THROWS_WITH(body.press({Facet<2>{0, 1}, Facet<2>{1, 0}}, 1), says("twice"));
  CHECK(body.state().prescribed->pressures.empty());
  CHECK_THROWS_WITH(body.press({}, 1), says("there is no facet"));
}

TEST_CASE("pressing the facets of a refined mesh replaces what they inherited", "[body]") {
  using F = Formulation<Tri3, Gauss<1>, NeoHookean>;
  auto const mesh = mesh::rectangle<Tri3>({.size = {1, 1}, .cells = {2, 2}});
  auto body = body_of<F>(MainBackend{}, mesh);
  auto const pressed = body.press(mesh.boundary("left"), 1);
  refine(body, {{5}});
  auto const left = body.mesh().boundary("left");
  REQUIRE(left.size() == 3);

  CHECK(body.press(left, 2) == pressed);

  REQUIRE(body.state().prescribed->pressures.size() == 1);
  CHECK(body.state().prescribed->pressures[0].facets == left);
  CHECK(body.state().prescribed->pressures[0].pascals == 2);
  CHECK_THROWS_WITH(body.press(mesh.boundary("left"), 1), says("is not on the boundary"));
}

}  // namespace pliant::test::pressure_suite
