#pragma once

#include <memory>
#include <string>

#include <Eigen/SparseCore>

#include <pliant/solver/linear/compiled_once.hpp>

namespace pliant::detail {

/// Solves with sparse matrices one after the other. The symbolic analysis is kept while the pattern stays
/// the same, and the factors while the values do too.
class DirectSolver {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// `name`: whose errors these are.
  explicit DirectSolver(std::string name);
  DirectSolver(DirectSolver&&) noexcept;
  DirectSolver& operator=(DirectSolver&&) noexcept;
  ~DirectSolver();

  int analyses() const;
  int factorisations() const;

  /// How many solves with the present factors of a symmetric matrix take as many operations as a factorisation; 0 where
  /// there are none.
  int solves_worth_a_factorisation() const;
  /// Whether the last matrix that was factorised is symmetric with a negative pivot.
  bool indefinite() const;
  /// Whether there are factors of a matrix with so many rows.
  bool fits(Eigen::Index rows) const;
  /// k⁻¹ r for the last k that was factorised.
  Eigen::VectorXd apply(Eigen::VectorXd const& r) const;

  /// k⁻¹ r, for a compressed k. Throws Error where k is singular.
  Eigen::VectorXd solve(Matrix const& k, Eigen::VectorXd const& r, bool is_symmetric);

 private:
  class Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace pliant::detail

#if !defined(PLIANT_COMPILED_SOLVERS)
#include <pliant/solver/linear/definitions/direct_solver.hpp>
#endif
