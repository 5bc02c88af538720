#pragma once

#include <pliant/law/decorators/viscosity.hpp>
#include <pliant/solver/newton.hpp>

#include "adaptation/plane_bodies.hpp"

// Static equilibrium without a matrix, beside that on the assembled one.
namespace pliant::test::without_matrix_suite {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Solid = Formulation<Tet10, Gauss<2>, SaintVenantKirchhoff>;
using Viscous = Formulation<Quad4, Gauss<2>, Prony<NeoHookean, 1>::law>;

template <class B, class F>
auto clamped_sheet(B const& backend, Group<F> group) {
  Body body{backend, mesh::rectangle({.size = {1, 0.5}, .cells = {6, 3}}), Elastic{2e5, 0.3, 1000},
            group};
  body.clamp(body.mesh().boundary("left"));
  return body;
}
template <class B>
constexpr double digits = sizeof(typename B::scalar) == 8 ? 1e-9 : 2e-4;

/// Solves two bodies, one without a matrix, and compares them.
template <class B, class Make>
NewtonReport compare(Make const& make, NewtonOptions options = {}) {
  auto with = make(), without = make();
  options.linear = LinearMethod::direct;
  auto const direct = solve_static(with, options);
  if (sizeof(typename B::scalar) == 4) options.tolerance = 1e-5;
  options.linear = LinearMethod::matrix_free;
  auto const report = solve_static(without, options);
  double const size = largest(with.displacements());
  CHECK(size > 1e-3);
  CHECK(difference(with.displacements(), without.displacements()) < digits<B> * size);
  CHECK(report.energy == Approx(direct.energy).epsilon(10 * digits<B>));
  CHECK(report.least_J.value == Approx(direct.least_J.value).epsilon(10 * digits<B>));
  CHECK(report.least_J.element == std::string(direct.least_J.element));
  if (sizeof(typename B::scalar) == 8) CHECK(report.least_J.number == direct.least_J.number);
  CHECK(report.linear.iterations > 0);
  CHECK(report.unknowns == direct.unknowns);
  if (sizeof(typename B::scalar) == 8) CHECK(report.iterations <= direct.iterations + 2);
  CHECK(report.factorisations == 0);
  return report;
}

TEST_CASE("rest without a matrix is rest with one", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    for (int load_steps : {1, 3})
      for (auto gravity : {MassMatrix::consistent, MassMatrix::lumped})
        compare<B>(
            [&] {
              auto body = clamped_sheet(backend, Group<Rubber>{});
              body.set_gravity({2, -4});
              body.set_load(3, {100, -300});
              return body;
            },
            {.load_steps = load_steps, .gravity = gravity});
  });
}

TEST_CASE("single precision rests within the tolerance, and where double does", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    if constexpr (sizeof(typename B::scalar) == 8) return;
    auto const make = [&] {
      auto body = clamped_sheet(backend, Group<Rubber>{});
      body.set_gravity({2, -4});
      body.drive(body.mesh().boundary("right"), [](double) { return Point<2>{0.05, -0.1}; });
      return body;
    };
    auto with = make(), without = make();
    solve_static(with);
    auto const report = solve_static(without, {.linear = LinearMethod::matrix_free});

    double const weight = 2e2;  // N, about
    CHECK(report.residual < 1e-9 * weight);
    double const size = largest(with.displacements());
    CHECK(difference(with.displacements(), without.displacements()) < 2e-7 * size);
  });
}

TEST_CASE("on a GPU no matrix is taken unasked but by small bodies", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    constexpr bool on_host = std::same_as<typename B::Recording, HostRecording>;
    auto const takes_none = [&](int cells) {
      Body body{backend, mesh::rectangle({.size = {1, 1}, .cells = {cells, cells}}),
                Elastic{2e5, 0.3, 1000}, Group<Rubber>{}};
      body.clamp(body.mesh().boundary("left"));
      auto const still = solve_static(body);
      CHECK(largest(body.displacements()) == 0);
      body.set_gravity({0, -4});
      auto const report = solve_static(body);
      CHECK(largest(body.displacements()) > 1e-3);
      CHECK(still.linear.method == report.linear.method);
      return report.linear.method == LinearMethod::matrix_free;
    };
    CHECK_FALSE(takes_none(10));
    CHECK(takes_none(20) == !on_host);
  });
}

TEST_CASE("driven nodes and hanging ones are where they are with a matrix", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    for (int load_steps : {1, 2}) {
      auto const report = compare<B>(
          [&] {
            Body body{backend, mesh::rectangle({.size = {1, 0.5}, .cells = {4, 2}}),
                      Elastic{2e5, 0.3, 1000}, Group<QuadRubber>{}, Group<QuadLinear>{}};
            refine(body, {{2, 5}});
            body.clamp(body.mesh().boundary("left"));
            body.set_gravity({0, -3});
            body.drive(body.mesh().boundary("right"), [](double) { return Point<2>{-0.2, 0.1}; });
            return body;
          },
          {.load_steps = load_steps});
      CHECK(report.iterations >= 2 * load_steps);
    }
  });
}

TEST_CASE("curved solids rest without a matrix", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    compare<B>([&] {
      Body body{backend, mesh::box<Tet10>({.size = {1, 0.5, 0.5}, .cells = {2, 1, 1}}),
                Elastic{2e5, 0.3, 1000}, Group<Solid>{}};
      body.clamp(body.mesh().boundary("left"));
      body.set_gravity({0, 0, -3});
      return body;
    });
  });
}

TEST_CASE("viscous laws rest without a matrix as after all time", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    Group<Viscous> const group{
        Prony<NeoHookean, 1>::law<double>{NeoHookean<double>::from({2e5, 0.3, 1000}), {0.5}, {1}}};
    compare<B>([&] {
      auto body = clamped_sheet(backend, group);
      body.set_gravity({0, -4});
      return body;
    });
  });
}

TEST_CASE("what cannot be solved without a matrix is told, and the body stays", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    NewtonOptions const without{.linear = LinearMethod::matrix_free};
    auto body = clamped_sheet(backend, Group<Rubber>{});
    body.set_gravity({0, -4});
    CHECK_THROWS_WITH(
        solve_static(body, {.max_iterations = 1, .linear = LinearMethod::matrix_free}),
        says("no convergence between 0 and 0.03125 of the loads"));
    CHECK_THROWS_WITH(
        solve_static(body, {.linear = LinearMethod::matrix_free, .max_linear_iterations = 0}),
        says("max_linear_iterations 0"));
    CHECK(largest(body.displacements()) == 0);
    body.press(body.mesh().boundary("right"), 100);
    CHECK_THROWS_WITH(solve_static(body, without), says("follow a surface"));

    // Drawn over itself: Saint Venant-Kirchhoff's law lets it fold.
    using Folding = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
    auto folded = clamped_sheet(backend, Group<Folding>{});
    folded.drive(folded.mesh().boundary("right"), [](double) { return Point<2>{-1.5, 0}; });
    CHECK_THROWS_AS(solve_static(folded, without), Error);
  });
}

}  // namespace pliant::test::without_matrix_suite
