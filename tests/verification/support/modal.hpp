#pragma once

#include <numbers>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <pliant/solver/assemble_mass.hpp>

#include "verification/support/statics.hpp"

namespace pliant::verification {

/// The lowest frequencies, Hz, of a body about where it is, by inverse iteration on a subspace (Bathe and
/// Wilson 1972). A body that nothing holds needs a shift: K + shift M is what is factorised.
template <class TheBody>
std::vector<double> frequencies(TheBody const& body, int count, MassMatrix kind, double shift = 0) {
  detail::StaticProblem<TheBody> const problem(body);
  Eigen::SparseMatrix<double> const m = problem.unknowns.restrict(assemble_mass(body, kind));
  Eigen::SparseMatrix<double> const k =
      problem.unknowns.restrict(assemble(body, problem.start()).stiffness) + shift * m;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> const factors(k);
  if (factors.info() != Eigen::Success) throw Error("frequencies: the stiffness is singular");
  int const size = std::min<int>(2 * count + 8, static_cast<int>(k.rows()));
  std::srand(1);
  Eigen::MatrixXd basis = Eigen::MatrixXd::Random(k.rows(), size);
  Eigen::VectorXd last = Eigen::VectorXd::Zero(count);
  for (int iteration = 0; iteration < 200; ++iteration) {
    Eigen::MatrixXd const next = factors.solve(m * basis);
    Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> const small(
        next.transpose() * (k * next), next.transpose() * (m * next));
    basis = next * small.eigenvectors();
    Eigen::VectorXd const found = small.eigenvalues().head(count);
    bool const settled = (found - last).cwiseAbs().maxCoeff() < 1e-12 * found.cwiseAbs().maxCoeff();
    last = found;
    if (settled) break;
  }
  std::vector<double> hertz;
  for (double squared : last)
    hertz.push_back(std::sqrt(std::max(0.0, squared - shift)) / (2 * std::numbers::pi));
  return hertz;
}

}  // namespace pliant::verification
