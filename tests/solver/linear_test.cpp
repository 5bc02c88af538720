#include <Eigen/Dense>

#include <pliant/reference.hpp>
#include <pliant/solve.hpp>
#include <pliant/solver/linear/conjugate_gradients.hpp>
#include <pliant/solver/linear/definitions/multilevel.hpp>
#include <pliant/solver/linear/direct_solver.hpp>
#include <pliant/solver/linear/minres.hpp>

#include "support/formulations.hpp"
#include "support/random.hpp"
#include "support/spring.hpp"

// Sparse matrices of blocks, conjugate gradients and the multilevel method, beside dense matrices and factors.
namespace pliant::test::linear {

using namespace pliant::detail;

template <int R, int C>
Eigen::MatrixXd dense(BlockMatrix<R, C> const& a) {
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(R * a.rows(), C * a.columns);
  for (Index row = 0; row < a.rows(); ++row)
    for (auto place = a.begin(row); place < a.end(row); ++place)
      for (int r = 0; r < R; ++r)
        for (int c = 0; c < C; ++c)
          full(R * row + r, C * a.column_at(place) + c) += a.at(place)[C * r + c];
  return full;
}

/// About a third of the blocks, with columns ascending.
template <int R, int C>
BlockMatrix<R, C> sparse(Index rows, Index columns, unsigned seed) {
  Random random(seed);
  BlockMatrix<R, C> a;
  a.columns = columns;
  for (Index row = 0; row < rows; ++row) {
    for (Index column = 0; column < columns; ++column)
      if (random() < -0.33) a.column.push_back(column);
    a.first.push_back(std::ssize(a.column));
  }
  a.clear_values();
  for (double& x : a.values) x = random();
  return a;
}

TEST_CASE("matrices of blocks multiply and transpose as dense ones", "[solver]") {
  HostTasks const tasks;
  auto const a = sparse<2, 3>(7, 5, 1);
  auto const b = sparse<3, 6>(5, 4, 2);
  CHECK((dense(product(tasks, a, b)) - dense(a) * dense(b)).norm() < 1e-14);
  CHECK(dense(transposed(a)) == Eigen::MatrixXd(dense(a).transpose()));
  Eigen::VectorXd const x = Eigen::VectorXd::LinSpaced(15, -1, 2);
  Eigen::VectorXd y;
  multiply(tasks, a, x, y);
  CHECK((y - dense(a) * x).norm() < 1e-14);
  for (Index row = 0; row < a.rows(); ++row)
    for (Index column = 0; column < a.columns; ++column) {
      auto const place = a.find(row, column);
      bool const there = dense(a).block<2, 3>(2 * row, 3 * column).norm() > 0;
      REQUIRE((place >= 0) == there);
    }
}

TEST_CASE("unknowns are taken out of vectors and matrices, and put back", "[solver]") {
  auto const a = sparse<2, 2>(4, 4, 3);
  Unknowns const unknowns({false, true, false, false, true, true, false, false});
  REQUIRE(unknowns.count() == 5);
  std::vector<Eigen::Index> const kept{0, 2, 3, 6, 7};
  Eigen::VectorXd const v = Eigen::VectorXd::LinSpaced(8, 1, 8);
  CHECK(unknowns.restrict(v) == Eigen::VectorXd(v(kept)));
  Eigen::VectorXd const back = unknowns.expand(unknowns.restrict(v));
  Eigen::VectorXd expected = v;
  unknowns.keep(expected);
  CHECK(back == expected);
  CHECK(expected[1] == 0);
  CHECK(expected[6] == 7);
  Eigen::MatrixXd const reduced = dense(a)(kept, kept);
  CHECK(Eigen::MatrixXd(unknowns.restrict(a)) == reduced);
  CHECK(Eigen::MatrixXd(unknowns.restrict(detail::by_scalars(a))) == reduced);
}

TEST_CASE("conjugate gradients end at the tolerance that was asked", "[solver]") {
  Eigen::MatrixXd const half = Eigen::MatrixXd(dense(sparse<3, 3>(10, 10, 4)));
  Eigen::MatrixXd const a = half * half.transpose() + Eigen::MatrixXd::Identity(30, 30);
  Eigen::VectorXd const b = Eigen::VectorXd::LinSpaced(30, -1, 1);
  auto const by_diagonal = [&](auto const& r, auto& z) { z = r.cwiseQuotient(a.diagonal()); };
  int before = 0;
  for (double tolerance : {1e-2, 1e-6, 1e-11}) {
    Eigen::VectorXd x;
    auto const cg = conjugate_gradients([&](auto const& v, auto& out) { out = a * v; }, by_diagonal,
                                        b, x, tolerance, 200);
    CHECK(cg.converged);
    CHECK((b - a * x).norm() <= 1.01 * tolerance * b.norm());
    Eigen::VectorXd const error = x - a.llt().solve(b);
    CHECK(std::sqrt(error.dot(a * error) / x.dot(a * x)) <= tolerance);
    CHECK(cg.iterations > before);
    before = cg.iterations;
  }
  Eigen::VectorXd x;
  auto const minus = conjugate_gradients([&](auto const& v, auto& out) { out = -(a * v); },
                                         by_diagonal, b, x, 1e-6, 200);
  CHECK(minus.indefinite);
  CHECK_FALSE(minus.converged);
  auto const few = conjugate_gradients([&](auto const& v, auto& out) { out = a * v; }, by_diagonal,
                                       b, x, 1e-11, 3);
  CHECK(few.iterations == 3);
  CHECK_FALSE(few.converged);
}

/// Symmetric, with so many eigenvalues below zero and others above, of sizes from 1 to 10.
Eigen::MatrixXd symmetric(Eigen::Index size, Eigen::Index negative, unsigned seed) {
  Random random(seed);
  Eigen::MatrixXd any(size, size);
  for (double& x : any.reshaped()) x = random();
  Eigen::MatrixXd const q = Eigen::HouseholderQR<Eigen::MatrixXd>(any).householderQ();
  Eigen::VectorXd values(size);
  for (Eigen::Index i = 0; i < size; ++i)
    values[i] = (5.5 + 4.5 * random()) * (i < negative ? -1 : 1);
  return q * values.asDiagonal() * q.transpose();
}

TEST_CASE("MINRES has the least residual of all in the Krylov space", "[solver]") {
  constexpr Eigen::Index n = 24;
  for (Eigen::Index negative : {0, 1, 9, 24}) {
    Eigen::MatrixXd const a = symmetric(n, negative, 5);
    Eigen::VectorXd const b = Eigen::VectorXd::LinSpaced(n, -1, 2);
    // M = L Lᵀ: the space and the norm are those of Lᵀ A L.
    Eigen::MatrixXd const m = symmetric(n, 0, 6), l = m.llt().matrixL();
    Eigen::MatrixXd const inner = l.transpose() * a * l;
    Eigen::MatrixXd basis(n, 0);
    for (int k = 1; k <= 8; ++k) {
      basis.conservativeResize(n, k);
      Eigen::VectorXd next = l.transpose() * b;
      if (k > 1) next = inner * basis.col(k - 2);
      basis.col(k - 1) = next.normalized();
      Eigen::VectorXd const y = (inner * basis).householderQr().solve(l.transpose() * b);
      Eigen::VectorXd x;
      auto const found = minres([&](auto const& v, auto& out) { out = a * v; },
                                [&](auto const& v, auto& out) { out = m * v; }, b, x, 1e-12, k);
      CHECK(found.iterations == k);
      CHECK((x - l * (basis * y)).norm() < 1e-8 * x.norm());
      CHECK(found.residual == Approx((b - a * x).norm()).epsilon(1e-10));
      // It knows when it is as small as that.
      auto const asked = minres([&](auto const& v, auto& out) { out = a * v; },
                                [&](auto const& v, auto& out) { out = m * v; }, b, x,
                                1.0001 * found.residual / b.norm(), n);
      CHECK(asked.converged);
      CHECK(asked.iterations <= k);
    }
  }
}

TEST_CASE("MINRES solves symmetric systems, definite or not, and tells which", "[solver]") {
  constexpr Eigen::Index n = 30;
  Eigen::VectorXd const b = Eigen::VectorXd::LinSpaced(n, -1, 1);
  auto const by_nothing = [](auto const& r, auto& z) { z = r; };
  for (Eigen::Index negative : {0, 1, 10, 30}) {
    Eigen::MatrixXd const a = symmetric(n, negative, 8);
    auto const apply_a = [&](auto const& v, auto& out) { out = a * v; };
    Eigen::VectorXd x, by_gradients;
    auto const found = minres(apply_a, by_nothing, b, x, 1e-11, 200);
    CHECK(found.converged);
    CHECK(found.indefinite == (negative > 0));
    CHECK((b - a * x).norm() <= 1.01e-11 * b.norm());
    CHECK((x - a.fullPivLu().solve(b)).norm() < 1e-9 * x.norm());
    auto const cg = conjugate_gradients(apply_a, by_nothing, b, by_gradients, 1e-11, 200);
    CHECK(cg.converged == (negative == 0));
    if (negative == 0) {
      CHECK((x - by_gradients).norm() < 1e-9 * x.norm());
      CHECK(found.iterations <= cg.iterations);
    }
  }
}

TEST_CASE("MINRES tells what has no solution, and what does not precondition", "[solver]") {
  Eigen::VectorXd const values = Eigen::Vector4d{2, -1, 3, 0}, b = Eigen::Vector4d{1, 2, 3, 4};
  auto const apply_a = [&](auto const& v, auto& out) { out = values.cwiseProduct(v); };
  auto const by_nothing = [](auto const& r, auto& z) { z = r; };
  Eigen::VectorXd x;
  auto const image = minres(apply_a, by_nothing, values.cwiseProduct(b), x, 1e-12, 100);
  CHECK(image.converged);
  CHECK((x - Eigen::VectorXd(Eigen::Vector4d{1, 2, 3, 0})).norm() < 1e-12);

  auto const outside = minres(apply_a, by_nothing, b, x, 1e-12, 100);
  CHECK_FALSE(outside.converged);
  CHECK(outside.iterations == 3);                                  // the Krylov space ends
  CHECK((x.head(3) - Eigen::Vector3d{0.5, -2, 1}).norm() < 1e-6);  // of least residual

  auto const nothing = minres(apply_a, by_nothing, Eigen::VectorXd::Zero(4), x, 1e-12, 100);
  CHECK(nothing.converged);
  CHECK(nothing.iterations == 0);
  CHECK(x == Eigen::VectorXd::Zero(4));

  auto const turned = [](auto const& r, auto& z) { z = -r; };
  auto const unfit = minres(apply_a, turned, b, x, 1e-12, 100);
  CHECK(unfit.indefinite);
  CHECK_FALSE(unfit.converged);
  CHECK(x == Eigen::VectorXd::Zero(4));
}

TEST_CASE("Krylov methods have converged where the residual is small, not their recursion",
          "[solver]") {
  constexpr Eigen::Index n = 40;
  Random random(9);
  Eigen::MatrixXd any(n, n);
  for (double& x : any.reshaped()) x = random();
  Eigen::MatrixXd const q = Eigen::HouseholderQR<Eigen::MatrixXd>(any).householderQ();
  // A solution so large that its rounding is 1e-9 of b.
  Eigen::VectorXd values(n);
  for (Eigen::Index i = 0; i < n; ++i)
    values[i] = std::pow(10, -8 * static_cast<double>(i) / (n - 1));
  Eigen::MatrixXd const a = q * values.asDiagonal() * q.transpose();
  Eigen::VectorXd const b = q * Eigen::VectorXd::Ones(n);
  auto const apply_a = [&](auto const& v, auto& out) { out = a * v; };
  auto const by_nothing = [](auto const& r, auto& z) { z = r; };
  auto const check = [&](auto const& solve) {
    for (double tolerance : {1e-4, 1e-7, 1e-13}) {
      Eigen::VectorXd x;
      KrylovReport const found = solve(x, tolerance);
      double const left = (b - a * x).norm();
      CHECK(found.residual == Approx(left));
      CHECK(found.converged == (left <= tolerance * b.norm()));
      CHECK(found.converged == (tolerance > 1e-10));
    }
  };
  check([&](auto& x, double tolerance) {
    return conjugate_gradients(apply_a, by_nothing, b, x, tolerance, 20000);
  });
  check([&](auto& x, double tolerance) {
    return minres(apply_a, by_nothing, b, x, tolerance, 20000);
  });
}

template <class F>
auto block_of(Index n, double poisson = 0.3, double push = 0.2) {
  constexpr std::size_t dim = F::dim;
  auto const mesh = [&] {
    if constexpr (dim == 3)
      return mesh::box<typename F::element>({.size = {1, 1, 1}, .cells = {n, n, n}});
    else
      return mesh::rectangle<typename F::element>({.size = {1, 1}, .cells = {n, n}});
  }();
  Body body{Reference<double>{}, mesh, Elastic{1e6, poisson, 1000}, Group<F>{}};
  body.clamp(mesh.boundary("left"));
  Point<dim> to{};
  to[0] = -push;
  body.drive(mesh.boundary("right"), [to](double) { return to; });
  return body;
}

/// Conjugate gradients for the stiffness at rest, with a multilevel preconditioner.
template <class F>
int iterations_of_multilevel(Index n) {
  constexpr int dim = F::dim;
  auto const body = block_of<F>(n);
  StaticProblem<decltype(block_of<F>(n))> const problem(body);
  AssembledBlocks<dim> sum;
  assemble_into(sum, body.parts(), Eigen::VectorXd::Zero(problem.size()), Assemble::stiffness,
                std::numeric_limits<double>::infinity(), 1);
  auto a = sum.stiffness;
  problem.unknowns.isolate_others(a);
  HostTasks const tasks;
  Multilevel<dim> m(tasks, a, body.mesh().nodes, problem.unknowns.fixed());
  REQUIRE(m.is_definite());
  CHECK(m.levels() >= 2);
  CHECK(m.operator_complexity() < 1.6);

  Eigen::VectorXd const r = Eigen::VectorXd::LinSpaced(problem.size(), -1, 1);
  Eigen::VectorXd const s = r.array().sin();
  Eigen::VectorXd mr, ms;
  m.apply(tasks, r, mr);
  m.apply(tasks, s, ms);
  CHECK(std::abs(s.dot(mr) - r.dot(ms)) < 1e-10 * s.norm() * mr.norm());

  Eigen::VectorXd x;
  auto const cg = conjugate_gradients([&](auto const& v, auto& out) { multiply(tasks, a, v, out); },
                                      [&](auto const& v, auto& out) { m.apply(tasks, v, out); }, r,
                                      x, 1e-8, 100);
  CHECK(cg.converged);
  Eigen::VectorXd const direct = problem.unknowns.expand(DirectSolver("test").solve(
      problem.unknowns.restrict(sum.stiffness), problem.unknowns.restrict(r), true));
  problem.unknowns.keep(x);
  CHECK((x - direct).norm() < 1e-6 * direct.norm());
  return cg.iterations;
}

using Plane = Formulation<Quad4, Gauss<2>, NeoHookean>;
using Solid = Formulation<Hex8, Gauss<2>, NeoHookean>;

TEST_CASE("iterations of the multilevel method hardly grow with the mesh", "[solver]") {
  int const coarse = iterations_of_multilevel<Plane>(16);
  CHECK(coarse <= 20);
  CHECK(iterations_of_multilevel<Plane>(48) <= coarse + 6);
  int const solid = iterations_of_multilevel<Solid>(6);
  CHECK(solid <= 16);
  CHECK(iterations_of_multilevel<Solid>(12) <= solid + 6);
}

template <class F>
void check_rigid_motions(Index n) {
  constexpr int dim = F::dim, modes = dim * (dim + 1) / 2;
  auto const body = block_of<F>(n);
  AssembledBlocks<dim> sum;
  assemble_into(sum, body.parts(), Eigen::VectorXd::Zero(dim * body.nodes()), Assemble::stiffness,
                std::numeric_limits<double>::infinity(), 1);
  std::vector<bool> const free(static_cast<std::size_t>(dim * body.nodes()), false);
  auto const motions = rigid_motions<dim>(body.mesh().nodes, free);
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, modes, Eigen::RowMajor>;
  Eigen::MatrixXd const all = Rows::Map(motions.data(), dim * body.nodes(), modes);
  Eigen::MatrixXd const k = dense(sum.stiffness);
  CHECK((k * all).norm() < 1e-12 * k.norm() * all.norm());
  CHECK(Eigen::FullPivLU<Eigen::MatrixXd>(all).rank() == modes);
  HostTasks const tasks;
  CHECK_FALSE(Multilevel<dim>(tasks, sum.stiffness, body.mesh().nodes, free).is_definite());
}

TEST_CASE("rigid motions meet no resistance, and a body that is free has no inverse", "[solver]") {
  check_rigid_motions<Plane>(12);
  check_rigid_motions<Solid>(5);
}

template <class F>
void check_methods(Index n) {
  auto by_factors = block_of<F>(n), by_levels = block_of<F>(n);
  auto const direct = solve_static(by_factors, {.linear = LinearMethod::direct});
  auto const levels = solve_static(by_levels, {.linear = LinearMethod::multilevel});
  CHECK(direct.linear.method == LinearMethod::direct);
  CHECK(direct.linear.hierarchies == 0);
  CHECK(direct.factorisations > 0);
  CHECK(levels.linear.method == LinearMethod::multilevel);
  CHECK(levels.factorisations == 0);
  CHECK(levels.linear.hierarchies >= 1);
  CHECK(levels.linear.iterations > 0);
  CHECK(levels.energy == Approx(direct.energy).epsilon(1e-10));
  auto const u = by_factors.displacements();
  CHECK(difference(by_levels.displacements(), u) < 1e-8 * largest(u));
}

TEST_CASE("factors and the multilevel method find the same equilibrium", "[solver]") {
  check_methods<Plane>(16);
  check_methods<Formulation<Tri3, Gauss<1>, NeoHookean>>(16);
  check_methods<Solid>(6);
}

TEST_CASE("the hierarchy of a definite stiffness serves an indefinite one", "[solver]") {
  auto const mesh = mesh::rectangle({.size = {1, 0.1}, .cells = {40, 4}});
  auto const solved = [&](LinearMethod method) {
    Body body{Reference<double>{}, mesh, Elastic{1e6, 0.3, 1000}, Group<Plane>{}};
    body.clamp(mesh.boundary("left"));
    body.drive(mesh.boundary("right"), [](double) { return Point<2>{-0.15, 0}; });
    body.set_load(102, {0, 100});
    return solve_static(body, {.linear = method});
  };
  auto const levels = solved(LinearMethod::multilevel), direct = solved(LinearMethod::direct);
  CHECK(direct.indefinite);
  CHECK(levels.indefinite);
  CHECK(levels.linear.minres > 0);
  CHECK(levels.factorisations == 0);
  CHECK(levels.linear.method == LinearMethod::multilevel);
  CHECK(levels.energy == Approx(direct.energy).epsilon(1e-9));
}

TEST_CASE("large bodies take the multilevel method unasked, and keep its hierarchy", "[solver]") {
  auto body = block_of<Solid>(9);
  auto const report = solve_static(body);
  CHECK(report.linear.method == LinearMethod::multilevel);
  CHECK(report.linear.hierarchies == 1);
  CHECK(report.iterations > 2);
  auto small = block_of<Solid>(3);
  CHECK(solve_static(small).linear.method == LinearMethod::direct);
}

TEST_CASE("nearly incompressible bodies are factorised", "[solver]") {
  auto body = block_of<Solid>(9, 0.4999, 0.1), exact = block_of<Solid>(9, 0.4999, 0.1);
  auto const report = solve_static(body);
  CHECK(report.linear.method == LinearMethod::direct);
  CHECK(report.linear.iterations < 200);  // lost before it is
  auto const direct = solve_static(exact, {.linear = LinearMethod::direct});
  CHECK(report.iterations <= direct.iterations + 1);
  CHECK(report.energy == Approx(direct.energy).epsilon(1e-10));
}

TEST_CASE("the stiffness of a linear body is assembled once", "[solver]") {
  using Linear = Formulation<Quad4, Gauss<2>, Hooke>;
  auto body = block_of<Linear>(12);
  auto rubber = block_of<Plane>(12);
  auto const report = solve_static(body, {.linear = LinearMethod::multilevel});
  CHECK(report.iterations > 1);
  CHECK(report.assemblies == 1);
  CHECK(report.linear.hierarchies == 1);
  CHECK(solve_static(rubber, {.linear = LinearMethod::multilevel}).assemblies > 2);
}

TEST_CASE("factors serve later matrices too", "[solver]") {
  auto body = block_of<Solid>(6);
  auto const report = solve_static(body, {.linear = LinearMethod::direct});
  CHECK(report.iterations >= 3);
  CHECK(report.factorisations < report.iterations);
  CHECK(report.linear.iterations > 0);
}

TEST_CASE("a large body that nothing holds is singular", "[solver]") {
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {50, 50}});
  Body body{Reference<double>{}, mesh, Elastic{1e6, 0.3, 1000}, Group<Plane>{}};
  body.set_load(0, {1, 1});
  body.set_load(static_cast<Index>(mesh.nodes.size()) - 1, {-1, -1});  // in balance
  CHECK_THROWS_WITH(solve_static(body), says("solve_static: the matrix is singular"));
  CHECK_THROWS_WITH(solve_static(body, {.linear = LinearMethod::multilevel}),
                    says("solve_static: the matrix is singular"));
}

TEST_CASE("force terms between nodes that share no element are assembled", "[solver]") {
  auto const mesh = mesh::rectangle({.size = {1, 1}, .cells = {3, 3}});
  Body body{Reference<double>{}, mesh, Elastic{1e6, 0.3, 1000}, Group<Plane>{}};
  auto const u = Eigen::VectorXd::Zero(2 * body.nodes());
  Eigen::MatrixXd const before = assemble(body, u).stiffness;
  body.add(std::vector<std::array<Index, 2>>{{0, 15}}, Spring<double>{3});
  body.add(std::vector<std::array<Index, 2>>{{3, 12}, {0, 1}}, Spring<double>{5});
  Eigen::MatrixXd added = Eigen::MatrixXd(assemble(body, u).stiffness) - before;
  for (auto const& [i, j, k] : {std::tuple{0, 15, 3.0}, {3, 12, 5.0}, {0, 1, 5.0}})
    for (int d = 0; d < 2; ++d) {
      added(2 * i + d, 2 * i + d) -= k;
      added(2 * j + d, 2 * j + d) -= k;
      added(2 * i + d, 2 * j + d) += k;
      added(2 * j + d, 2 * i + d) += k;
    }
  CHECK(added.norm() < 1e-9);
}

}  // namespace pliant::test::linear
