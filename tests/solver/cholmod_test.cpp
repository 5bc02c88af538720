// The library's solvers of matrices where a program links pliant::cholmod.
#include <random>
#include <vector>

#include <Eigen/Dense>

#include <pliant/solver/linear/direct_solver.hpp>

#include "support/catch.hpp"

#if !defined(PLIANT_CHOLMOD)
#error "without pliant::cholmod this tests nothing"
#endif

using namespace pliant;
using detail::DirectSolver;
using Matrix = DirectSolver::Matrix;

namespace {

/// A chain of springs of random stiffnesses, each node tied to the next ones, and to the ground by `ground`.
Matrix chain(int nodes, double ground, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> stiffness(1, 2);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < nodes; ++i) {
    entries.emplace_back(i, i, ground);
    for (int j : {i + 1, i + 7, i + 200}) {
      if (j >= nodes) continue;
      double const k = stiffness(random);
      for (auto [a, b, sign] : {std::tuple{i, i, 1}, {j, j, 1}, {i, j, -1}, {j, i, -1}})
        entries.emplace_back(a, b, sign * k);
    }
  }
  Matrix k(nodes, nodes);
  k.setFromTriplets(entries.begin(), entries.end());
  return k;
}
double residual(Matrix const& k, Eigen::VectorXd const& x, Eigen::VectorXd const& r) {
  return (k * x - r).norm() / r.norm();
}

}  // namespace

TEST_CASE("supernodal factors solve definite systems, and keep their analysis", "[solver]") {
  int const nodes = GENERATE(100, 3000);  // by columns, and by dense blocks of them
  Eigen::VectorXd const r = Eigen::VectorXd::Random(nodes);
  DirectSolver solver("solve");
  for (unsigned seed : {1u, 2u, 3u}) {
    auto const k = chain(nodes, 0.1, seed);
    CHECK(residual(k, solver.solve(k, r, true), r) < 1e-12);
    CHECK(residual(k, solver.apply(r), r) < 1e-12);
    CHECK_FALSE(solver.indefinite());
    CHECK(solver.fits(nodes));
    // Factors of small matrices are made anew as fast as they solve.
    if (nodes > 1000) CHECK(solver.solves_worth_a_factorisation() > 10);
  }
  CHECK(solver.analyses() == 1);
  CHECK(solver.factorisations() == 3);
  auto const same = chain(nodes, 0.1, 3);
  (void)solver.solve(same, r, true);
  CHECK(solver.factorisations() == 3);
}

TEST_CASE("supernodal factors leave indefinite and general systems to others", "[solver]") {
  int const nodes = 3000;
  Eigen::VectorXd const r = Eigen::VectorXd::Random(nodes);
  DirectSolver solver("solve");
  auto indefinite = chain(nodes, 0.1, 1);
  indefinite.coeffRef(nodes / 2, nodes / 2) = -5;
  CHECK(residual(indefinite, solver.solve(indefinite, r, true), r) < 1e-10);
  CHECK(solver.indefinite());

  auto const definite = chain(nodes, 0.1, 1);
  CHECK(residual(definite, solver.solve(definite, r, true), r) < 1e-12);
  CHECK_FALSE(solver.indefinite());

  auto general = chain(nodes, 0.1, 1);
  general.coeffRef(0, 1) = 0.3;
  CHECK(residual(general, solver.solve(general, r, false), r) < 1e-12);
}

TEST_CASE("supernodal factors refuse singular systems", "[solver]") {
  auto const free = chain(3000, 0, 1);
  DirectSolver solver("solve");
  CHECK_THROWS_WITH(solver.solve(free, Eigen::VectorXd::Random(3000), true),
                    test::says("solve: the matrix is singular"));
  auto const held = chain(3000, 0.1, 1);
  Eigen::VectorXd const r = Eigen::VectorXd::Random(3000);
  CHECK(residual(held, solver.solve(held, r, true), r) < 1e-12);
}
