#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/SparseCholesky>

#include <pliant/openmp.hpp>
#include <pliant/pliant.hpp>
#include <pliant/solve.hpp>
#include <pliant/solver/linear/conjugate_gradients.hpp>
#include <pliant/solver/linear/direct_solver.hpp>
#include <pliant/solver/linear/multilevel.hpp>

#if defined(PLIANT_BENCH_PETSC)
#include <petscksp.h>
#endif

// How long statics take: a block of Hex8 under neo-Hooke's law, compressed by 20% in one step; and one system with
// its stiffness at rest, solved to 1e-6 by the multilevel method and by direct and multilevel solvers of others that are
// here (Eigen's, CHOLMOD where the program links it, PETSc's GAMG with the rigid motions), in turns in one program; the least times count. A line of JSON each.
// Arguments, all optional: cells along an edge, threads, turns.
namespace pliant::bench {

using F = Formulation<Hex8, Gauss<2>, NeoHookean>;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::SparseMatrix<double>;
constexpr double tolerance = 1e-6;
/// Cells along an edge up to which factors take seconds.
#if defined(PLIANT_CHOLMOD)
constexpr int most_factorised = 40;
#else
constexpr int most_factorised = 16;
#endif

auto block(int cells, int threads) {
  auto const mesh = mesh::box<Hex8>({.size = {1, 1, 1}, .cells = {cells, cells, cells}});
  Body body{OpenMP<double>{{.threads = threads}}, mesh, Elastic{1e6, 0.3, 1000}, Group<F>{}};
  body.clamp(mesh.boundary("left"));
  body.drive(mesh.boundary("right"), [](double) { return Point<3>{-0.2, 0, 0}; });
  return body;
}

double seconds(std::function<void()> const& work) {
  using Clock = std::chrono::steady_clock;
  auto const start = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Solver {
  std::string name;
  std::function<void()> set_up;
  std::function<Vector()> solve;
  double least_set_up = 1e30, least_solve = 1e30, residual = 0;
};

#if defined(PLIANT_BENCH_PETSC)
/// Conjugate gradients with GAMG, to a relative residual.
class Gamg {
 public:
  Gamg(Matrix const& k, std::vector<double> const& places) : k_(k), places_(places) {
    PetscInitializeNoArguments();
  }
  void set_up() {
    if (ksp_) {
      KSPDestroy(&ksp_);
      MatDestroy(&a_);
    }
    auto const n = static_cast<PetscInt>(k_.rows());
    MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, const_cast<int*>(k_.outerIndexPtr()),
                              const_cast<int*>(k_.innerIndexPtr()),
                              const_cast<double*>(k_.valuePtr()), &a_);
    MatSetBlockSize(a_, 3);
    MatSetOption(a_, MAT_SPD, PETSC_TRUE);
    Vec coordinates;
    VecCreateSeqWithArray(PETSC_COMM_SELF, 3, n, places_.data(), &coordinates);
    MatNullSpace rigid;
    MatNullSpaceCreateRigidBody(coordinates, &rigid);
    MatSetNearNullSpace(a_, rigid);
    MatNullSpaceDestroy(&rigid);
    VecDestroy(&coordinates);
    KSPCreate(PETSC_COMM_SELF, &ksp_);
    KSPSetType(ksp_, KSPCG);
    KSPSetNormType(ksp_, KSP_NORM_UNPRECONDITIONED);
    PC pc;
    KSPGetPC(ksp_, &pc);
    PCSetType(pc, PCGAMG);
    KSPSetTolerances(ksp_, tolerance, 1e-300, 1e30, 1000);
    KSPSetOperators(ksp_, a_, a_);
    KSPSetUp(ksp_);
  }
  Vector solve(Vector const& r) {
    Vector x(r.size());
    Vec in, out;
    VecCreateSeqWithArray(PETSC_COMM_SELF, 3, r.size(), r.data(), &in);
    VecCreateSeqWithArray(PETSC_COMM_SELF, 3, x.size(), x.data(), &out);
    KSPSolve(ksp_, in, out);
    VecDestroy(&in);
    VecDestroy(&out);
    return x;
  }

 private:
  Matrix const& k_;
  std::vector<double> const& places_;
  KSP ksp_ = nullptr;
  Mat a_ = nullptr;
};
#endif

void time_static(int cells, int threads, int turns, LinearMethod method, char const* name) {
  double whole = 1e30;
  NewtonReport report;
  for (int turn = 0; turn < turns; ++turn) {
    auto body = block(cells, threads);
    whole = std::min(
        whole, seconds([&] { report = solve_static(body, NewtonOptions{.linear = method}); }));
  }
  std::printf(
      "{\"case\": \"solve_static, %s\", \"cells\": %d, \"threads\": %d, \"unknowns\": %d, "
      "\"seconds\": %.4g, \"iterations\": %d, \"of_conjugate_gradients\": %d, \"hierarchies\": %d, "
      "\"factorisations\": %d, \"energy\": %.12g}\n",
      name, cells, threads, report.unknowns, whole, report.iterations, report.linear.iterations,
      report.linear.hierarchies, report.factorisations, report.energy);
}

void compare(int cells, int threads, int turns) {
  time_static(cells, threads, turns, LinearMethod::automatic, "automatic");
  if (cells <= most_factorised) time_static(cells, threads, turns, LinearMethod::direct, "direct");

  auto const body = block(cells, threads);
  detail::StaticProblem<std::remove_const_t<decltype(body)>> const problem(body);
  auto const& unknowns = problem.unknowns;
  HostTasks const tasks(body.parts().backend);
  detail::AssembledBlocks<3> sum;
  double const assembling = seconds([&] {
    detail::assemble_into(sum, body.parts(), Vector::Zero(problem.size()), Assemble::stiffness,
                          std::numeric_limits<double>::infinity(), 1);
  });
  Matrix const k = unknowns.restrict(sum.stiffness);
  Vector full = Vector::LinSpaced(problem.size(), -1, 1).array().sin();
  unknowns.keep(full);
  Vector const r = unknowns.restrict(full);
  std::printf("{\"case\": \"assembly\", \"unknowns\": %d, \"seconds\": %.4g}\n", unknowns.count(),
              assembling);

  std::vector<Solver> solvers;
  auto a = sum.stiffness;
  std::unique_ptr<detail::Multilevel<3>> multilevel;
  solvers.push_back({"Pliant, multilevel",
                     [&] {
                       a = sum.stiffness;
                       unknowns.isolate_others(a);
                       multilevel = std::make_unique<detail::Multilevel<3>>(
                           tasks, a, body.mesh().nodes, unknowns.fixed());
                     },
                     [&] {
                       Vector x;
                       detail::conjugate_gradients(
                           [&](auto const& v, auto& out) { detail::multiply(tasks, a, v, out); },
                           [&](auto const& v, auto& out) { multilevel->apply(tasks, v, out); },
                           full, x, tolerance, 1000);
                       return unknowns.restrict(x);
                     }});
  Eigen::SimplicialLDLT<Matrix> simplicial;
  if (unknowns.count() < 12000)
    solvers.push_back({"Eigen, SimplicialLDLT", [&] { simplicial.compute(k); },
                       [&] { return Vector(simplicial.solve(r)); }});
#if defined(PLIANT_CHOLMOD)
  std::unique_ptr<detail::DirectSolver> direct;
  if (unknowns.count() < 250000)
    solvers.push_back({"Pliant, direct by CHOLMOD",
                       [&] {
                         direct = std::make_unique<detail::DirectSolver>("bench");
                         (void)direct->solve(k, r, true);
                       },
                       [&] { return direct->apply(r); }});
#endif
#if defined(PLIANT_BENCH_PETSC)
  std::vector<double> places;
  for (std::size_t i = 0; i < unknowns.fixed().size(); ++i)
    if (!unknowns.fixed()[i]) places.push_back(body.mesh().nodes[i / 3][i % 3]);
  Gamg gamg(k, places);
  solvers.push_back({"PETSc, CG with GAMG", [&] { gamg.set_up(); }, [&] { return gamg.solve(r); }});
#endif
  for (int turn = 0; turn < turns; ++turn)
    for (auto& solver : solvers) {
      Vector x;
      solver.least_set_up = std::min(solver.least_set_up, seconds(solver.set_up));
      solver.least_solve = std::min(solver.least_solve, seconds([&] { x = solver.solve(); }));
      solver.residual = (r - k * x).norm() / r.norm();
    }
  double const own = solvers[0].least_set_up + solvers[0].least_solve;
  for (auto const& solver : solvers)
    std::printf(
        "{\"case\": \"one system\", \"unknowns\": %d, \"threads\": %d, \"solver\": \"%s\", "
        "\"set_up\": %.4g, \"solve\": %.4g, \"residual\": %.2g, \"over_pliant\": %.3g}\n",
        unknowns.count(), threads, solver.name.c_str(), solver.least_set_up, solver.least_solve,
        solver.residual, (solver.least_set_up + solver.least_solve) / own);
}

}  // namespace pliant::bench

int main(int argc, char** argv) {
  auto const argument = [&](int k, int otherwise) {
    return argc > k ? std::atoi(argv[k]) : otherwise;
  };
  pliant::bench::compare(argument(1, 21), argument(2, 1), argument(3, 3));
}
