#pragma once

#include <array>
#include <numeric>
#include <optional>

#include <Eigen/Dense>

#include <pliant/solver/implicit.hpp>
#include <pliant/solver/newton.hpp>

#include "adaptation/plane_bodies.hpp"
#include "support/random.hpp"

// MINRES without a matrix: systems of shifted tangents K − σ M, indefinite where σ lies between eigenvalues, beside
// dense factors; and bodies whose tangents are indefinite.
namespace pliant::test::minres_suite {

using namespace pliant::detail;
using Softening = Formulation<Quad4, Gauss<2>, SaintVenantKirchhoff>;
using Rubber = Formulation<Quad4, Gauss<2>, NeoHookean>;

template <class B>
constexpr bool is_double = sizeof(typename B::scalar) == 8;

/// A sheet of few unknowns with random displacements, and systems of its tangent and masses.
template <class B>
struct Sheet {
  using TheBody = decltype(body_of<Rubber>(std::declval<B>(), mesh::rectangle({})));
  using Parts = typename TheBody::parts_type;
  using Values = Eigen::VectorXd;

  Mesh<Quad4> mesh = mesh::rectangle({.size = {1, 0.5}, .cells = {5, 3}});
  TheBody body;
  Parts& parts;
  Balance<Parts> balance;
  Eigen::MatrixXd stiffness;
  Values mass;

  explicit Sheet(B const& backend, bool held = true)
      : body(body_of<Rubber>(backend, mesh)),
        parts(body.parts()),
        balance(parts, MassMatrix::lumped, 0) {
    if (held) body.clamp(mesh.boundary("left"));
    auto u = Random(7).field<2>(mesh.nodes.size(), 0.02);
    for (std::size_t i = 0; i < u.size(); ++i)
      if (!held || mesh.nodes[i][0] == 0) u[i] = {};
    body.set_displacements(u);
    StaticProblem<TheBody> const problem(body);
    unknowns_.emplace(problem.unknowns);
    stiffness = Eigen::MatrixXd(unknowns_->restrict(assemble(body, problem.start()).stiffness));
    Values masses(problem.size());
    for (Index i = 0; i < masses.size(); ++i)
      masses[i] = parts.layout.mass_list()[static_cast<std::size_t>(i / 2)];
    mass = unknowns_->restrict(masses);
  }
  Eigen::MatrixXd matrix(double shift) const {
    return stiffness - shift * Eigen::MatrixXd(mass.asDiagonal());
  }
  /// Between the eigenvalues `below` and `below` + 1 of K x = λ M x, from 0.
  double shift_above(int below) const {
    Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> const solver(
        stiffness, Eigen::MatrixXd(mass.asDiagonal()), Eigen::EigenvaluesOnly);
    return (solver.eigenvalues()[below] + solver.eigenvalues()[below + 1]) / 2;
  }
  Values random(unsigned seed) const {
    Values b(mass.size());
    Random numbers(seed);
    for (double& x : b) x = numbers();
    return b;
  }
  struct Solved {
    KrylovReport report;
    LinearReport linear;
    Values x;
  };
  Solved solve(double shift, Values const& b, KrylovMethod method, double tolerance,
               Preconditioner preconditioner = Preconditioner::nodal_blocks) {
    auto& arrays = balance.arrays();
    auto const field = StaticProblem<TheBody>::per_node(unknowns_->expand(b));
    arrays.residual.upload(parts.layout.padded(field));
    ShiftedTangent<Parts> const a{-shift, MassMatrix::lumped,      1, std::as_const(parts).u(),
                                  0,      std::as_const(parts).u()};
    Preconditioning<Parts> by(preconditioner);
    auto const report = solve_matrix_free(parts, arrays, a, tolerance, 1000, by, method);
    return {report, by.report(),
            unknowns_->restrict(
                StaticProblem<TheBody>::flat(parts.layout.in_user_order(arrays.solution)))};
  }

 private:
  std::optional<Unknowns> unknowns_;
};

TEST_CASE("indefinite systems have the solutions that dense factors find", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    Sheet<B> sheet(backend);
    double const tolerance = is_double<B> ? 1e-10 : 1e-4;
    for (int negative : {1, 4, 15}) {
      double const shift = sheet.shift_above(negative - 1);
      auto const b = sheet.random(static_cast<unsigned>(negative));
      auto const a = sheet.matrix(shift);
      Eigen::VectorXd const expected = a.ldlt().solve(b);
      auto const found = sheet.solve(shift, b, KrylovMethod::minres, tolerance);
      CHECK(found.report.converged);
      CHECK(found.report.indefinite);
      CHECK(found.linear.minres == 1);
      CHECK(found.report.residual == Approx((b - a * found.x).norm()).epsilon(0.02));
      CHECK((b - a * found.x).norm() < 1.02 * tolerance * b.norm());
      CHECK((found.x - expected).norm() < (is_double<B> ? 1e-7 : 2e-2) * expected.norm());
      auto const gradients = sheet.solve(shift, b, KrylovMethod::conjugate_gradients, tolerance);
      CHECK(gradients.report.indefinite);
      CHECK_FALSE(gradients.report.converged);
    }
  });
}

TEST_CASE("systems are solved where the residual is small, not a recursion of it", "[solver]") {
  on_each_backend<std::tuple<Reference<float>>>([]<class B>(B const& backend) {
    Sheet<B> sheet(backend);
    for (auto method : {KrylovMethod::minres, KrylovMethod::conjugate_gradients}) {
      double const shift = method == KrylovMethod::minres ? sheet.shift_above(3) : -100;
      auto const b = sheet.random(4);
      auto const a = sheet.matrix(shift);
      for (double tolerance : {1e-5, 3e-6, 1e-6, 1e-8}) {
        auto const found = sheet.solve(shift, b, method, tolerance);
        double const left = (b - a * found.x).norm();
        CHECK(found.report.residual == Approx(left).epsilon(0.5));
        CAPTURE(tolerance, left / b.norm(), found.report.iterations);
        if (found.report.converged) CHECK(left < 1.5 * tolerance * b.norm());
        // 1e-6 is near what single precision reaches, which depends on how a compiler rounds.
        if (tolerance != 1e-6) CHECK(found.report.converged == (tolerance > 1e-7));
        CHECK(left < 2e-5 * b.norm());
        CHECK(found.report.iterations < 500);
      }
    }
  });
}

TEST_CASE("definite systems have one solution, whatever the method", "[solver]") {
  on_each_backend<AllBackends>([]<class B>(B const& backend) {
    Sheet<B> sheet(backend);
    double const tolerance = is_double<B> ? 1e-11 : 1e-5;
    auto const b = sheet.random(5);
    for (double shift : {0.0, -100.0}) {
      auto const gradients = sheet.solve(shift, b, KrylovMethod::conjugate_gradients, tolerance);
      auto const minres = sheet.solve(shift, b, KrylovMethod::minres, tolerance);
      auto const automatic = sheet.solve(shift, b, KrylovMethod::automatic, tolerance);
      for (auto const& found : {gradients, minres, automatic}) {
        CHECK(found.report.converged);
        CHECK_FALSE(found.report.indefinite);
        CHECK((found.x - gradients.x).norm() < (is_double<B> ? 1e-8 : 5e-3) * gradients.x.norm());
      }
      CHECK(automatic.linear.minres == 0);
      CHECK(automatic.x == gradients.x);
      // The least residual of all in the same space, but for the norm that it is least in.
      CHECK(minres.report.iterations <= gradients.report.iterations + 2);
    }
  });
}

TEST_CASE("MINRES finds one solution under each preconditioner", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    Sheet<B> sheet(backend);
    auto const b = sheet.random(11);
    for (double shift : {0.0, sheet.shift_above(3)}) {
      Eigen::VectorXd const expected = sheet.matrix(shift).ldlt().solve(b);
      std::vector<int> iterations;
      for (auto by :
           {Preconditioner::nodal_blocks, Preconditioner::chebyshev, Preconditioner::multigrid}) {
        auto const found = sheet.solve(shift, b, KrylovMethod::minres, 1e-10, by);
        CHECK(found.report.converged);
        CHECK(found.report.indefinite == (shift > 0));
        CHECK((found.x - expected).norm() < 1e-7 * expected.norm());
        iterations.push_back(found.report.iterations);
      }
      if (shift == 0) {
        CHECK(3 * iterations[1] < 2 * iterations[0]);
        CHECK(2 * iterations[2] < iterations[0]);
      }
    }
  });
}

TEST_CASE("singular systems are solved where they have solutions, and told where not", "[solver]") {
  on_each_backend<MainAlone>([]<class B>(B const& backend) {
    Sheet<B> sheet(backend, false);  // at rest and free: rigid motions meet no resistance
    auto const a = sheet.matrix(0);
    Eigen::VectorXd const b = a * sheet.random(9);
    auto const found = sheet.solve(0, b, KrylovMethod::minres, 1e-9);
    CHECK(found.report.converged);
    CHECK((b - a * found.x).norm() < 2e-9 * b.norm());

    Eigen::VectorXd const pushed = b + Eigen::VectorXd::Constant(b.size(), b.norm());
    CHECK_FALSE(sheet.solve(0, pushed, KrylovMethod::minres, 1e-9).report.converged);

    auto const nothing =
        sheet.solve(0, Eigen::VectorXd::Zero(b.size()), KrylovMethod::minres, 1e-9);
    CHECK(nothing.report.converged);
    CHECK(nothing.report.iterations == 0);
    CHECK(nothing.x.norm() == 0);
  });
}

/// A bar of Saint Venant-Kirchhoff's law that is pressed to half of its length, where it has no resistance left, and then pushed.
template <class B>
auto pressed_bar(B const& backend) {
  auto const mesh = mesh::rectangle({.size = {1, 0.25}, .cells = {4, 1}});
  auto body = body_of<Softening>(backend, mesh);
  std::vector<Index> all(mesh.nodes.size());
  std::iota(all.begin(), all.end(), Index{0});
  body.hold(all, 2);
  body.hold(mesh.boundary("left"), 1);
  body.drive(mesh.boundary("right"), [](double) { return Point<2>{-0.5, 0}; }, {.directions = 1});
  solve_static(body, {.linear = LinearMethod::direct});
  for (Index i = 0; i < body.nodes(); ++i) body.set_load(i, {1e-4 * (i % 5), 0});
  return body;
}

template <class Run>
auto with_each_method(Run const& run) {
  CHECK_THROWS_WITH(run(LinearMethod::matrix_free, KrylovMethod::conjugate_gradients),
                    says("is not positive definite"));
  return std::array{run(LinearMethod::direct, KrylovMethod::automatic),
                    run(LinearMethod::matrix_free, KrylovMethod::automatic),
                    run(LinearMethod::matrix_free, KrylovMethod::minres)};
}

TEST_CASE("a bar without resistance is brought into balance where conjugate gradients find no way",
          "[solver]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    auto const before = pressed_bar(backend).displacements();
    SECTION("at rest") {
      auto const found = with_each_method([&](LinearMethod linear, KrylovMethod krylov) {
        auto body = pressed_bar(backend);
        auto const report = solve_static(body, {.linear = linear, .krylov = krylov});
        CHECK(report.indefinite);
        CHECK((report.linear.minres > 0) == (linear == LinearMethod::matrix_free));
        return body.displacements();
      });
      for (auto const& u : found) CHECK(difference(u, found[0]) < 1e-9);
      CHECK(difference(found[0], before) > 1e-4);
    }
    SECTION("in a step of backward Euler") {
      auto const found = with_each_method([&](LinearMethod linear, KrylovMethod krylov) {
        auto body = pressed_bar(backend);
        Implicit step{BackwardEuler{}, {.step = 20, .linear = linear, .krylov = krylov}};
        auto const report = step(body);
        CHECK((report.linear.minres > 0) == (linear == LinearMethod::matrix_free));
        return body.displacements();
      });
      for (auto const& u : found) CHECK(difference(u, found[0]) < 1e-8);
      CHECK(difference(found[0], before) > 1e-4);
    }
  });
}

TEST_CASE("MINRES finds the saddle of a column that factors find, conjugate gradients its bend",
          "[solver]") {
  on_each_backend<DoubleBackends>([]<class B>(B const& backend) {
    struct Found {
      NewtonReport report;
      FieldOf<2> u;
    };
    auto const solved = [&](LinearMethod linear, KrylovMethod krylov) -> Found {
      auto const mesh = mesh::rectangle({.size = {1, 0.1}, .cells = {16, 1}});
      auto body = body_of<Rubber>(backend, mesh);
      body.clamp(mesh.boundary("left"));
      body.drive(mesh.boundary("right"), [](double) { return Point<2>{-0.2, 0}; });
      solve_static(body, {.linear = LinearMethod::direct});  // straight
      for (Index i = 0; i < body.nodes(); ++i) body.set_load(i, {0, 1e-4});
      auto const report = solve_static(body, {.linear = linear, .krylov = krylov});
      return {report, body.displacements()};
    };
    auto const factors = solved(LinearMethod::direct, KrylovMethod::automatic);
    auto const minres = solved(LinearMethod::matrix_free, KrylovMethod::minres);
    CHECK(factors.report.indefinite);
    CHECK(minres.report.indefinite);
    CHECK(minres.report.iterations <= factors.report.iterations + 2);
    CHECK(minres.report.linear.minres == minres.report.iterations);
    CHECK(difference(minres.u, factors.u) < 1e-8 * largest(factors.u));
    for (auto method : {KrylovMethod::automatic, KrylovMethod::conjugate_gradients}) {
      auto const bent = solved(LinearMethod::matrix_free, method).report;
      CHECK_FALSE(bent.indefinite);
      CHECK(bent.energy < 0.6 * factors.report.energy);
    }
  });
}

}  // namespace pliant::test::minres_suite
