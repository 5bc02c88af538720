#include <pliant/solve.hpp>

#include "support/formulations.hpp"

// What loads a body at rest, and from where its loads grow.
namespace pliant::test::static_loads_test {

using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

template <Element E>
auto beam() {
  if constexpr (E::dim == 2)
    return mesh::rectangle<E>({.size = {0.8, 0.1}, .cells = {8, 1}});
  else
    return mesh::box<E>({.size = {4, 1, 1}, .cells = {3, 1, 1}});
}
template <Element E, class Q, class Load>
auto hanging(Load const& load, NewtonOptions const& options = {}) {
  auto const mesh = beam<E>();
  Body body{Reference<double>{}, mesh, Elastic{1.5e6, 0.35, 1100},
            Group<Formulation<E, Q, Hooke>>{}};
  body.clamp(mesh.boundary("left"));
  load(body);
  auto const report = solve_static(body, options);
  CHECK(report.gravity == options.gravity);
  return body.displacements();
}

template <Element E, class Q>
void check_gravity(double error_of_lumped) {
  INFO(E::name());
  Point<E::dim> g{}, per_volume{};
  g[1] = -9.81;
  per_volume[1] = -9.81 * 1100;
  auto const pulled = [&](auto& body) { body.set_gravity(g); };
  auto const expected =
      hanging<E, Q>([&](auto& body) { body.set_loads(body_loads(body.mesh(), per_volume)); });
  auto const consistent = hanging<E, Q>(pulled);
  auto const lumped = hanging<E, Q>(pulled, {.gravity = MassMatrix::lumped});
  CHECK(difference(consistent, expected) < 1e-9 * largest(expected));
  CHECK(difference(lumped, expected) > error_of_lumped * largest(expected));
}

TEST_CASE("gravity at rest does the work of a distributed force", "[solver]") {
  check_gravity<Tri6, Gauss<2>>(1e-4);
  check_gravity<Quad8, Gauss<3>>(1e-4);
  check_gravity<Tet10, Gauss<2>>(1e-3);
  check_gravity<Hex20, Gauss<3>>(1e-3);
}

TEST_CASE("lumped gravity finds the rest of dynamics", "[solver]") {
  auto const mesh = beam<Tri6>();
  Body body{Reference<double>{}, mesh, Elastic{1.5e6, 0.35, 1100},
            Group<Formulation<Tri6, Gauss<2>, NeoHookean>>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -9.81});
  solve_static(body, {.gravity = MassMatrix::lumped});
  auto const u = body.displacements();
  CentralDifference step{};
  step(body, 100);
  CHECK(difference(body.displacements(), u) < 1e-9 * largest(u));
}

TEST_CASE("static reactions bear the weight of a body", "[solver]") {
  auto const mesh = beam<Tri6>();
  Body body{Reference<double>{}, mesh, Elastic{1.5e6, 0.35, 1100},
            Group<Formulation<Tri6, Gauss<2>, NeoHookean>>{}};
  auto const left = body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -9.81});
  double const weight = 9.81 * 1100 * 0.8 * 0.1;

  solve_static(body);
  CHECK(total(static_reactions(body, left))[1] == Approx(weight).epsilon(1e-9));

  solve_static(body, {.gravity = MassMatrix::lumped});
  auto const own = static_reactions(body, left, MassMatrix::lumped);
  CHECK(total(own)[1] == Approx(weight).epsilon(1e-9));
  CHECK(difference(own, body.reactions(left)) < 1e-10 * weight);
  CHECK_THROWS_WITH(static_reactions(body, Handle{7}), says("handle 7 names no condition"));
}

auto pressed_block(Motion<2> const& motion) {
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {16, 16}});
  Body body{Reference<double>{}, mesh, Elastic{1, 0.3, 1}, Group<Rubber>{}};
  body.clamp(mesh.boundary("bottom"));
  body.drive(mesh.boundary("top"), motion);
  return body;
}

TEST_CASE("driven nodes take the inside with them in the first linear solve", "[solver]") {
  // The way of the top is three times as long as its row of elements is high.
  auto body = pressed_block([](double) { return Point<2>{0, -0.2}; });
  auto const report = solve_static(body);
  CHECK(report.iterations <= 6);

  auto const& mesh = body.mesh();
  Body other{Reference<double>{}, mesh, Elastic{1, 0.3, 1}, Group<Rubber>{}};
  auto u = mesh.nodes;
  for (auto& p : u) p = {0, -0.2 * p[1]};
  other.set_displacements(u);
  other.clamp(mesh.boundary("bottom"));
  other.clamp(mesh.boundary("top"));
  solve_static(other);
  CHECK(difference(body.displacements(), other.displacements()) < 1e-9);
}

TEST_CASE("a way in load steps begins before the body was driven", "[solver]") {
  // At once, it would stretch the last row to five times its height, and further than the law's limit.
  using Limited = Formulation<Quad4, Gauss<2>, Gent>;
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {16, 16}});
  Body body{Reference<double>{}, mesh, Elastic{1, 0.3, 1}, Group<Limited>{{{0.4, 2, 0.8}}}};
  body.clamp(mesh.boundary("bottom"));
  body.drive(mesh.boundary("top"), [](double) { return Point<2>{0, 0.25}; });
  solve_static(body, {.load_steps = 4});
  auto const top = nodes_of(mesh.boundary("top"));
  CHECK(body.displacements()[static_cast<std::size_t>(top[0])][1] == 0.25);
}

TEST_CASE("a way in load steps begins where the body was put after it was driven", "[solver]") {
  auto const drive = [](double) { return Point<2>{0, -0.05}; };
  auto const rest = pressed_block(drive);
  auto solved = pressed_block(drive);
  solve_static(solved);
  auto body = pressed_block(drive);
  REQUIRE(difference(body.displacements(), rest.displacements()) == 0);
  body.set_displacements(solved.displacements());
  CHECK(solve_static(body, {.tolerance = 1e-9}).iterations == 0);
}

TEST_CASE("a second solution starts where the body is", "[solver]") {
  double way = -0.05;
  auto body = pressed_block([&](double) { return Point<2>{0, way}; });
  body.set_gravity({0, -0.01});
  solve_static(body, {.load_steps = 3});
  auto const u = body.displacements();

  CHECK(solve_static(body, {.load_steps = 3, .tolerance = 1e-9}).iterations == 0);
  CHECK(difference(body.displacements(), u) == 0);

  way = -0.06;
  auto const report = solve_static(body, {.load_steps = 3});
  CHECK(report.iterations <= 9);
  auto fresh = pressed_block([](double) { return Point<2>{0, -0.06}; });
  fresh.set_gravity({0, -0.01});
  solve_static(fresh);
  CHECK(difference(body.displacements(), fresh.displacements()) < 1e-9);
}

TEST_CASE("loads that change grow from those that the body bears", "[solver]") {
  auto const mesh = beam<Quad4>();
  Body body{Reference<double>{}, mesh, Elastic{1.5e6, 0.35, 1100}, Group<Rubber>{}};
  body.clamp(mesh.boundary("left"));
  body.press(mesh.boundary("bottom"), 100);
  solve_static(body, {.load_steps = 4});
  auto const bent = body.displacements();
  CHECK(solve_static(body, {.load_steps = 4, .tolerance = 1e-9}).iterations == 0);
  CHECK(difference(body.displacements(), bent) == 0);

  body.press(mesh.boundary("bottom"), 110);
  solve_static(body, {.load_steps = 2});
  Body fresh{Reference<double>{}, mesh, Elastic{1.5e6, 0.35, 1100}, Group<Rubber>{}};
  fresh.clamp(mesh.boundary("left"));
  fresh.press(mesh.boundary("bottom"), 110);
  solve_static(fresh);
  CHECK(difference(body.displacements(), fresh.displacements()) < 1e-9 * largest(bent));
}

TEST_CASE("a static solution is a change by hand for integrators that watch the energy",
          "[solver]") {
  auto const mesh = beam<Quad4>();
  Body body{Reference<double>{}, mesh, Elastic{1.5e6, 0.35, 1100}, Group<Rubber>{}};
  body.clamp(mesh.boundary("left"));
  body.set_gravity({0, -9.81});
  CentralDifference step{};
  step(body, 300);
  double const before = total_energy(body), by_hand = body.state().energy_by_hand;

  solve_static(body);

  double const added = total_energy(body) - before;
  CHECK(added < 0);
  CHECK(body.state().energy_by_hand - by_hand == Approx(added).epsilon(1e-2));
  CHECK_FALSE(body.parts().has_checkpoint);
  auto const steps = body.steps();
  step(body, 300);
  CHECK(body.steps() == steps + 300);
}

}  // namespace pliant::test::static_loads_test
