#include <limits>

#include <pliant/solve.hpp>
#include <pliant/solver/linear/direct_solver.hpp>

#include "support/formulations.hpp"

// What solve_static says of its answer and of its work, and what it refuses.
namespace pliant::test::static_report_test {

using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

/// Two triangles whose side is pulled about by the node in its middle: folded at a corner, where no point of
/// the rule looks.
template <template <class> class L>
auto pulled_about(NewtonOptions const& options = {}) {
  auto const mesh = mesh::rectangle<Tri6>({.size = {1, 1}, .cells = {1, 1}});
  Body body{Reference<double>{}, mesh, soft, Group<Formulation<Tri6, Gauss<2>, L>>{}};
  body.clamp(mesh.boundary("left"));
  std::size_t middle = 0;
  while (mesh.nodes[middle] != Point<2>{1, 0.5}) ++middle;
  body.set_load(static_cast<Index>(middle), {-2, 5});
  auto const report = solve_static(body, options);
  return std::pair{report, body.displacements()};
}

TEST_CASE("an answer that is folded between the points of a rule is refused", "[solver]") {
  CHECK_THROWS_WITH(pulled_about<NeoHookean>(), says("solve_static: the answer is folded"));
  auto const [report, u] = pulled_about<NeoHookean>({.accept_folded = true});
  CHECK(report.least_J.value < -0.1);
  CHECK(report.least_J.element == std::string("Tri6"));
  CHECK(largest(u) > 0.1);
}

TEST_CASE("a refused answer leaves the body as it was", "[solver]") {
  auto const mesh = mesh::rectangle<Tri6>({.size = {1, 1}, .cells = {1, 1}});
  Body body{Reference<double>{}, mesh, soft, Group<Formulation<Tri6, Gauss<2>, NeoHookean>>{}};
  body.clamp(mesh.boundary("left"));
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (mesh.nodes[i] == Point<2>{1, 0.5}) body.set_load(static_cast<Index>(i), {-2, 5});
  CHECK_THROWS_AS(solve_static(body), Error);
  CHECK(largest(body.displacements()) == 0);
}

TEST_CASE("a start that is folded is refused where the law has no energy for it", "[solver]") {
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
  for (int load_steps : {1, 3}) {
    Body body{Reference<double>{}, mesh, soft, Group<Rubber>{}};
    body.clamp(mesh.boundary("left"));
    auto u = body.displacements();
    u[13] = {0.4, 0};  // beyond its neighbours
    body.set_displacements(u);
    CHECK_THROWS_WITH(solve_static(body, {.load_steps = load_steps}),
                      says("are not finite where load steps start"));
    CHECK(difference(body.displacements(), u) == 0);
  }
}

TEST_CASE("folds mean nothing to Hooke's law, and are reported", "[solver]") {
  auto const [report, u] = pulled_about<Hooke>();
  CHECK(report.least_J.value < 0);
}

TEST_CASE("the least J of a uniform state is that of the state", "[solver]") {
  auto const mesh = distorted_mesh<Quad8>(3);
  Body body{Reference<double>{}, mesh, soft, Group<Formulation<Quad8, Gauss<3>, NeoHookean>>{}};
  body.set_displacements(uniform(mesh.nodes, Tensor<double, 2>{{{0.2, 0.4}, {0, -0.1}}}));
  body.clamp(boundary_nodes(mesh));
  CHECK(solve_static(body).least_J.value == Approx(1.2 * 0.9).epsilon(1e-9));
}

TEMPLATE_TEST_CASE("the least J is found for every element", "[solver]", Tri3, Tri6, Quad4, Quad9,
                   Tet4, Tet10, Hex8, Hex20, Wedge6, Pyramid5) {
  using E = TestType;
  Mesh<E> mesh;
  for (int a = 0; a < E::nodes; ++a) {
    Point<E::dim> place;
    for (int k = 0; k < E::dim; ++k) place[static_cast<std::size_t>(k)] = E::place(a)[k];
    mesh.nodes.push_back(place);
  }
  Connectivity<E> nodes;
  for (std::size_t a = 0; a < E::nodes; ++a) nodes[a] = static_cast<Index>(a);
  mesh.template elements<E>() = {nodes};
  Body body{Reference<double>{}, mesh, soft, Group<Formulation<E, Gauss<3>, Hooke>>{}};
  auto h = Tensor<double, E::dim>::zero();
  h(0, 0) = -0.3;
  h(0, 1) = 0.5;
  body.set_displacements(uniform(mesh.nodes, h));
  std::vector<Index> all(nodes.begin(), nodes.end());
  body.clamp(all);
  auto const report = solve_static(body);
  CHECK(report.unknowns == 0);
  CHECK(report.least_J.value == Approx(0.7).epsilon(1e-12));
  CHECK(report.least_J.number == 0);
}

template <class F>
auto pulled_strip(int load_steps) {
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {8, 2}});
  Body body{Reference<double>{}, mesh, soft, Group<F>{}};
  body.clamp(mesh.boundary("left"));
  body.drive(mesh.boundary("right"), [](double) { return Point<2>{0.1, 0.02}; });
  body.set_load(13, {0, 0.03});
  body.set_gravity({0, -0.1});
  return solve_static(body, {.load_steps = load_steps});
}

TEST_CASE("a saddle is told from rest", "[solver]") {
  // A slender column that is pressed together, and stays straight by its symmetry.
  auto const pressed = [](double by, LinearMethod method) {
    auto const mesh = mesh::rectangle({.size = {1, 0.1}, .cells = {10, 2}});
    auto body = body_of<Rubber>(Reference<double>{}, mesh);
    body.clamp(mesh.boundary("left"));
    body.drive(mesh.boundary("right"), [by](double) { return Point<2>{-by, 0}; });
    return solve_static(body, {.linear = method}).indefinite;
  };
  for (auto method : {LinearMethod::automatic, LinearMethod::direct}) {
    CHECK_FALSE(pressed(0.005, method));
    CHECK(pressed(0.15, method));
  }
}

TEST_CASE("a linear problem takes one factorisation", "[solver]") {
  CHECK(pulled_strip<Linear>(1).factorisations == 1);
  auto const report = pulled_strip<Linear>(5);
  CHECK(report.factorisations == 1);
  CHECK(report.iterations >= 5);
  CHECK(pulled_strip<Rubber>(1).factorisations > 1);
}

TEST_CASE("a step of Newton's method assembles the stiffness once", "[solver]") {
  for (int load_steps : {1, 3}) {
    auto const report = pulled_strip<Rubber>(load_steps);
    CHECK(report.assemblies == report.iterations);
    CHECK(report.factorisations == report.iterations);
  }
}

TEST_CASE("the symbolic analysis is kept while the pattern stays", "[solver]") {
  Eigen::SparseMatrix<double> k(2, 2), other(2, 2);
  k.insert(0, 0) = 2;
  k.insert(1, 1) = 4;
  k.makeCompressed();
  other = k;
  other.coeffRef(1, 0) = other.coeffRef(0, 1) = 1;
  other.makeCompressed();
  Eigen::VectorXd const r = Eigen::VectorXd::Ones(2);
  detail::DirectSolver direct("test");
  CHECK(direct.solve(k, r, true)[1] == Approx(0.25));
  CHECK(direct.solve(k, r, true)[0] == Approx(0.5));
  CHECK(direct.factorisations() == 1);
  k.coeffRef(1, 1) = 8;
  CHECK(direct.solve(k, r, true)[1] == Approx(0.125));
  CHECK(direct.factorisations() == 2);
  CHECK(direct.analyses() == 1);
  CHECK(direct.solve(other, r, true)[0] == Approx(3.0 / 7));
  CHECK(direct.analyses() == 2);
  other.coeffRef(1, 0) = 0;
  CHECK(direct.solve(other, r, false)[0] == Approx(0.375));
  k.coeffRef(0, 0) = 0;
  CHECK_THROWS_WITH(direct.solve(k, r, true), says("test: the matrix is singular"));
  CHECK(direct.solve(other, r, false)[0] == Approx(0.375));
}

TEST_CASE("absurd options of the static solver are refused", "[solver]") {
  double const inf = std::numeric_limits<double>::infinity();
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {2, 1}});
  Body body{Reference<double>{}, mesh, soft, Group<Rubber>{}};
  body.clamp(mesh.boundary("left"));
  CHECK_THROWS_WITH(solve_static(body, {.load_steps = 0}), says("load_steps 0"));
  CHECK_THROWS_WITH(solve_static(body, {.load_steps = -1}), says("load_steps -1"));
  CHECK_THROWS_WITH(solve_static(body, {.max_iterations = 0}), says("max_iterations 0"));
  for (double tolerance : {0.0, -1e-9, 1.0, inf, double{NAN}})
    CHECK_THROWS_WITH(solve_static(body, {.tolerance = tolerance}), says("a tolerance of"));
}

}  // namespace pliant::test::static_report_test
