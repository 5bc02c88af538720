#pragma once

#include <pliant/law/decorators/viscosity.hpp>
#include <pliant/solver/implicit.hpp>
#include <pliant/solver/newton.hpp>

#include "adaptation/plane_bodies.hpp"
#include "solver/anchor.hpp"
#include "support/repeatable.hpp"

// What conjugate gradients find does not depend on what preconditions them; how soon they find it does.
namespace pliant::test::preconditioners_suite {

inline constexpr Elastic material{2e5, 0.3, 1000};
using Bricks = Formulation<Hex8, Gauss<2>, SaintVenantKirchhoff>;
using Curved = Formulation<Tet10, Gauss<2>, SaintVenantKirchhoff>;
using Viscous = Formulation<Quad4, Gauss<2>, Prony<NeoHookean, 1>::law>;

template <class TheBody>
NewtonReport rest(TheBody& body, Preconditioner preconditioner, double tolerance = 1e-9) {
  return solve_static(body, {.tolerance = sizeof(typename TheBody::scalar) == 8 ? tolerance : 1e-4,
                             .linear = LinearMethod::matrix_free,
                             .preconditioner = preconditioner});
}
/// Brings bodies to rest by each preconditioner. Multigrid takes at most `most` of the iterations under nodal blocks.
template <class Make>
void compare(Make const& make, double most) {
  auto nodal = make();
  using T = typename decltype(nodal)::scalar;
  auto const without = rest(nodal, Preconditioner::nodal_blocks);
  auto const expected = nodal.displacements();
  CHECK(largest(expected) > 1e-4);
  CHECK(without.linear.levels == 1);
  CHECK(without.linear.hierarchies == 0);
  for (auto preconditioner : {Preconditioner::chebyshev, Preconditioner::multigrid}) {
    auto body = make();
    auto const report = rest(body, preconditioner);
    CHECK(difference(body.displacements(), expected) <
          (sizeof(T) == 8 ? 1e-8 : 2e-3) * largest(expected));
    CHECK(report.linear.preconditioner == preconditioner);
    CHECK(report.linear.fallbacks == 0);
    CHECK(report.linear.hierarchies >= 1);
    CHECK(report.linear.setup > 0);
    bool const grids = preconditioner == Preconditioner::multigrid;
    CHECK((report.linear.levels > 1) == grids);
    CHECK(report.linear.iterations < (grids ? most : 0.5) * without.linear.iterations);
  }
}

TEST_CASE("multigrid finds the rest of curved, mixed and slender bodies", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    SECTION("curved") {
      compare(
          [&] {
            Body body{backend, distorted_mesh<Tet10>(3), material, Group<Curved>{}};
            body.clamp(body.mesh().boundary("left"));
            body.set_gravity({0, 0, -3});
            return body;
          },
          0.2);
    }
    SECTION("slender") {
      compare(
          [&] {
            auto const mesh = mesh::box<Hex8>({.size = {20, 1, 1}, .cells = {40, 2, 2}});
            Body body{backend, mesh, material, Group<Bricks>{}};
            body.clamp(mesh.boundary("left"));
            body.drive(mesh.boundary("right"), [](double) { return Point<3>{-0.2, 0, 0}; });
            return body;
          },
          0.2);
    }
    SECTION("mixed") {
      compare(
          [&] {
            auto body = plane_body(backend, mixed_mesh(16));
            body.clamp(body.mesh().boundary("left"));
            body.set_gravity({0, -0.1});
            return body;
          },
          0.2);
    }
  });
}

TEST_CASE("multigrid finds the rest of bodies with hanging nodes, springs and past", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    SECTION("graded") {
      compare(
          [&] {
            auto body = plane_body(backend, mesh::rectangle({.size = {2, 1}, .cells = {16, 8}}));
            for (double reach : {0.5, 0.25, 0.12}) {
              Marks marks(1);
              auto const& mesh = body.mesh();
              for_each_element(mesh, [&](auto, std::size_t e, auto const& nodes) {
                auto const at = middle(mesh.nodes[static_cast<std::size_t>(nodes[0])],
                                       mesh.nodes[static_cast<std::size_t>(nodes[2])]);
                if (std::hypot(at[0] - 1, at[1] - 0.5) < reach)
                  marks[0].push_back(static_cast<Index>(e));
              });
              refine(body, marks);
            }
            body.clamp(body.mesh().boundary("left"));
            body.drive(body.mesh().boundary("right"), [](double) { return Point<2>{-0.1, 0.1}; });
            return body;
          },
          0.25);
    }
    SECTION("springs") {
      compare(
          [&] {
            auto body = plane_body(backend, mesh::rectangle({.size = {2, 1}, .cells = {24, 12}}));
            std::vector<std::array<Index, 1>> nodes;
            for (Index i = 0; i < body.nodes(); i += 3) nodes.push_back({i});
            body.add(nodes, Anchor<double>{0.02});
            body.hold(body.mesh().boundary("left"), 1);
            body.set_gravity({0, -0.1});
            return body;
          },
          0.25);
    }
    SECTION("viscous") {
      Group<Viscous> const group{
          Prony<NeoHookean, 1>::law<double>{NeoHookean<double>::from(material), {0.5}, {1}}};
      compare(
          [&] {
            Body body{backend, mesh::rectangle({.size = {2, 1}, .cells = {20, 10}}), material,
                      group};
            body.clamp(body.mesh().boundary("left"));
            body.set_gravity({0, -2});
            return body;
          },
          0.2);
    }
  });
}

/// Sheared, with the iterations that took.
template <class F, class B, class M>
int iterations_of(B const& backend, M const& mesh, Preconditioner preconditioner) {
  Body body{backend, mesh, material, Group<F>{}};
  body.clamp(mesh.boundary("left"));
  body.drive(mesh.boundary("right"), [](double) {
    Point<F::dim> pull{};
    pull[1] = 0.1;
    return pull;
  });
  return rest(body, preconditioner, 1e-6).linear.iterations;
}

TEST_CASE("iterations under multigrid hardly grow with the number of elements", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    SECTION("plane") {
      std::vector<int> nodal, grids;
      for (int n : {13, 26, 52}) {
        auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {n, n}});
        nodal.push_back(iterations_of<QuadLinear>(backend, mesh, Preconditioner::nodal_blocks));
        grids.push_back(iterations_of<QuadLinear>(backend, mesh, Preconditioner::multigrid));
      }
      CHECK(nodal[2] > 3 * nodal[0]);
      CHECK(2 * grids[2] <= 3 * grids[0]);
      CHECK(grids[2] < 20);
    }
    SECTION("solid") {
      using Linear = Formulation<Hex8, Gauss<2>, Hooke>;
      std::vector<int> nodal, grids;
      for (int n : {6, 12}) {
        auto const mesh = mesh::box<Hex8>({.size = {1, 1, 1}, .cells = {n, n, n}});
        nodal.push_back(iterations_of<Linear>(backend, mesh, Preconditioner::nodal_blocks));
        grids.push_back(iterations_of<Linear>(backend, mesh, Preconditioner::multigrid));
      }
      CHECK(10 * nodal[1] > 16 * nodal[0]);
      CHECK(2 * grids[1] <= 3 * grids[0]);
      CHECK(grids[1] < 15);
    }
  });
}

template <class B>
auto sheet(B const& backend, int cells) {
  auto const mesh = mesh::rectangle({.size = {2, 1}, .cells = {2 * cells, cells}});
  auto body = plane_body(backend, mesh);
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -0.1});
  return body;
}

TEST_CASE("multigrid is taken where nodal blocks take many iterations", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto small = sheet(backend, 4), large = sheet(backend, 28);
    CHECK(rest(small, Preconditioner::automatic).linear.preconditioner ==
          Preconditioner::nodal_blocks);
    bool const on_host = std::same_as<typename B::Recording, HostRecording>;
    CHECK(rest(large, Preconditioner::automatic).linear.preconditioner ==
          (on_host ? Preconditioner::multigrid : Preconditioner::nodal_blocks));
  });
}

TEST_CASE("multigrid is kept as long as it serves, and its grids with the mesh", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = sheet(backend, 12);
    body.set_gravity({0, -0.02});
    auto const first = rest(body, Preconditioner::multigrid);
    CHECK(first.iterations >= 3);
    CHECK(first.linear.hierarchies == 1);
    auto const u = body.displacements();
    auto const& arrays = *body.parts().solver;
    auto const* const kept = arrays.preconditioner.get();
    REQUIRE(kept != nullptr);
    REQUIRE(arrays.recorded.has_value());
    CHECK(arrays.recorded->preconditioner == kept);

    body.set_displacements(FieldOf<2>(u.size()));
    auto const second = rest(body, Preconditioner::multigrid);
    CHECK(second.linear.hierarchies == 1);
    CHECK(arrays.preconditioner.get() == kept);
    CHECK(difference(body.displacements(), u) <= between_runs(1e-9));
    refine(body, {{0}});
    CHECK(rest(body, Preconditioner::multigrid).linear.levels > 1);
  });
}

TEST_CASE("what no longer preconditions is made anew, and given up where that does not help",
          "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto body = sheet(backend, 12);
    auto& parts = body.parts();
    using Parts = typename decltype(body)::parts_type;
    detail::Balance<Parts> balance(parts, MassMatrix::lumped, 0);
    auto& arrays = balance.arrays();
    detail::ShiftedTangent<Parts> const a{0, MassMatrix::lumped,      1, std::as_const(parts).u(),
                                          0, std::as_const(parts).u()};
    detail::Preconditioning<Parts> by(Preconditioner::multigrid);
    auto const solve = [&] {
      balance.weigh(balance.field(arrays.residual));
      auto const report = solve_matrix_free(parts, arrays, a, 1e-8, 1000, by);
      CHECK(report.converged);
      return report.iterations;
    };
    int const usual = solve();
    CHECK(solve() == usual);
    CHECK(by.report().hierarchies == 1);

    auto blocks = download<double>(arrays.blocks);
    for (double& x : blocks) x = -x;
    arrays.blocks.upload(blocks);
    CHECK(solve() <= usual + 1);
    CHECK(by.report().hierarchies == 2);
    CHECK(by.report().fallbacks == 0);

    by.begin_anew();
    by.begin(parts, arrays, a);
    CHECK(by.replace(parts, arrays, a));
    CHECK(by.report().fallbacks == 1);
    CHECK(by.now() == Preconditioner::nodal_blocks);
    CHECK(!by.replace(parts, arrays, a));
    CHECK(solve() > 2 * usual);
  });
}

TEST_CASE("implicit steps do not depend on the preconditioner, nor on who takes them", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    auto const options = [](Preconditioner preconditioner) {
      return ImplicitOptions{.step = 0.5,
                             .stiffness_damping = 0.01,
                             .linear = LinearMethod::matrix_free,
                             .preconditioner = preconditioner};
    };
    auto nodal = sheet(backend, 12), grids = sheet(backend, 12), one_by_one = sheet(backend, 12);
    auto const without = Implicit{BDF2{}, options(Preconditioner::nodal_blocks)}(nodal, 3);
    auto const with = Implicit{BDF2{}, options(Preconditioner::multigrid)}(grids, 3);
    for (int k = 0; k < 3; ++k)
      (void)Implicit{BDF2{}, options(Preconditioner::multigrid)}(one_by_one);
    auto const u = nodal.displacements();
    CHECK(largest(u) > 0.01);
    CHECK(difference(grids.displacements(), u) < 1e-7 * largest(u));
    CHECK(with.linear.hierarchies == 3);
    CHECK(with.linear.preconditioner == Preconditioner::multigrid);
    CHECK(2 * with.linear.iterations < without.linear.iterations);
    CHECK(difference(one_by_one.displacements(), grids.displacements()) <= between_runs(1e-9));
  });
}

}  // namespace pliant::test::preconditioners_suite
