#pragma once

#include <pliant/solver/newton.hpp>

#include "support/formulations.hpp"

// Linear elements on the cells of quadratic ones, between these and grids around the body.
namespace pliant::test::p_multigrid_suite {

inline constexpr Elastic material{2e5, 0.3, 1000};
template <class E>
using Law = Formulation<E, Gauss<TensorCell<typename E::cell> && E::degree == 2 ? 3 : 2>,
                        SaintVenantKirchhoff>;

/// n cells along each axis, bent to a quarter of a ring.
template <Element E>
Mesh<E> bent_mesh(int n) {
  Mesh<E> mesh;
  if constexpr (E::dim == 3)
    mesh = mesh::box<E>({.size = {1, 1, 1}, .cells = {n, n, n}});
  else
    mesh = mesh::raised<E>(regular_mesh<LinearOf<E>>(n));
  for (auto& x : mesh.nodes) {
    double const r = 1 + x[0], angle = 1.2 * x[1];
    x[0] = r * std::cos(angle);
    x[1] = r * std::sin(angle);
  }
  return mesh;
}
template <Element E, class B>
auto pulled(B const& backend, Mesh<E> const& mesh) {
  Body body{backend, mesh, material, Group<Law<E>>{}};
  body.clamp(mesh.boundary("bottom"));
  body.drive(mesh.boundary("top"), [](double) {
    Point<E::dim> pull{};
    pull[0] = 0.02;
    return pull;
  });
  return body;
}
template <class TheBody>
NewtonReport rest(TheBody& body, Preconditioner preconditioner, double tolerance) {
  return solve_static(body, {.tolerance = tolerance,
                             .linear = LinearMethod::matrix_free,
                             .preconditioner = preconditioner});
}

/// By linear elements and by factors.
template <Element E, class B>
void compare(B const& backend, Mesh<E> const& mesh) {
  bool const is_double = sizeof(typename B::scalar) == 8;
  auto body = pulled(backend, mesh), expected = pulled(backend, mesh);
  auto const report = rest(body, Preconditioner::p_multigrid, is_double ? 1e-9 : 1e-4);
  CAPTURE(E::name());
  CHECK(report.linear.preconditioner == Preconditioner::p_multigrid);
  CHECK(report.linear.levels >= 3);
  CHECK(report.linear.fallbacks == 0);
  CHECK(report.linear.setup > 0);
  solve_static(expected, {.linear = LinearMethod::direct});
  auto const u = expected.displacements();
  CHECK(largest(u) > 0.01);
  CHECK(difference(body.displacements(), u) < (is_double ? 1e-8 : 2e-3) * largest(u));
}

TEST_CASE("p-multigrid finds the rest that factors find", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    compare(backend, bent_mesh<Tri6>(5));
    compare(backend, bent_mesh<Tet10>(2));
    if constexpr (runs_all<B>) {
      compare(backend, bent_mesh<Quad8>(5));
      compare(backend, bent_mesh<Quad9>(5));
      compare(backend, bent_mesh<Hex20>(2));
      compare(backend, bent_mesh<Hex27>(2));
    }
  });
}

/// Iterations of meshes of n cells along each axis.
template <Element E, class B>
std::vector<int> iterations(B const& backend, std::vector<int> const& sizes,
                            Preconditioner preconditioner) {
  std::vector<int> list;
  for (int n : sizes) {
    auto body = pulled(backend, bent_mesh<E>(n));
    list.push_back(rest(body, preconditioner, 1e-6).linear.iterations);
  }
  return list;
}

TEST_CASE("iterations under p-multigrid hardly grow with the number of elements", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    std::vector<int> const sizes{8, 16, 32};
    auto const nodal = iterations<Quad9>(backend, sizes, Preconditioner::nodal_blocks),
               linear = iterations<Quad9>(backend, sizes, Preconditioner::p_multigrid);
    CAPTURE(nodal, linear);
    CHECK(nodal[2] > 3 * nodal[0]);
    CHECK(4 * linear[2] <= 5 * linear[0]);
    CHECK(8 * linear[2] < nodal[2]);
    auto const grids = iterations<Tet10>(backend, {6}, Preconditioner::multigrid),
               solid = iterations<Tet10>(backend, {3, 6}, Preconditioner::p_multigrid);
    CAPTURE(grids, solid);
    CHECK(4 * solid[1] <= 5 * solid[0]);
    CHECK(solid[1] < grids[0]);
  });
}

TEST_CASE("multigrid takes the place of p-multigrid where nodes hang or degrees mix", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    SECTION("hanging nodes") {
      auto body = pulled(backend, bent_mesh<Quad9>(6));
      refine(body, {{0, 7}});
      CHECK(rest(body, Preconditioner::p_multigrid, 1e-6).linear.preconditioner ==
            Preconditioner::multigrid);
    }
    SECTION("degrees") {
      Mesh<Quad4, Quad9> mesh;
      auto const linear = mesh::rectangle({.size = {1, 1}, .cells = {6, 6}});
      mesh.nodes = linear.nodes;
      mesh.boundaries = linear.boundaries;
      mesh.template elements<Quad4>() = linear.template elements<Quad4>();
      Body body{backend, mesh, material, Group<Law<Quad4>>{}, Group<Law<Quad9>>{}};
      body.clamp(body.mesh().boundary("bottom"));
      body.set_gravity({0, -1});
      CHECK(rest(body, Preconditioner::p_multigrid, 1e-6).linear.preconditioner ==
            Preconditioner::multigrid);
    }
  });
}

TEST_CASE("p-multigrid is taken for quadratic elements that do not lie in a grid's boxes",
          "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    bool const on_host = std::same_as<typename B::Recording, HostRecording>;
    auto const taken = [&](Mesh<Quad9> const& mesh) {
      auto body = pulled(backend, mesh);
      return rest(body, Preconditioner::automatic, 1e-9).linear.preconditioner;
    };
    auto const nodal = Preconditioner::nodal_blocks;
    CHECK(taken(bent_mesh<Quad9>(3)) == nodal);
    CHECK(taken(bent_mesh<Quad9>(24)) == (on_host ? Preconditioner::p_multigrid : nodal));
    CHECK(taken(mesh::raised<Quad9>(regular_mesh<Quad4>(24))) ==
          (on_host ? Preconditioner::multigrid : nodal));
  });
}

}  // namespace pliant::test::p_multigrid_suite
