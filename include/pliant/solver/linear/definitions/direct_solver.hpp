#pragma once

#include <algorithm>
#include <utility>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include <pliant/error.hpp>
#include <pliant/solver/linear/direct_solver.hpp>

namespace pliant::detail {

class DirectSolver::Factors {
 public:
  explicit Factors(std::string name) : name_(std::move(name)) {}

  int analyses() const { return analyses_; }
  int factorisations() const { return factorisations_; }

  int solves_worth_a_factorisation() const {
    return has_factors_ && by_symmetric_ ? solves_worth_ : 0;
  }
  bool indefinite() const { return has_factors_ && by_symmetric_ && negative_pivots_; }
  bool fits(Eigen::Index rows) const { return has_factors_ && matrix_.rows() == rows; }
  Eigen::VectorXd apply(Eigen::VectorXd const& r) const { return symmetric_.solve(r); }

  Eigen::VectorXd solve(Matrix const& k, Eigen::VectorXd const& r, bool is_symmetric) {
    if (!has_factors_ || is_symmetric != is_symmetric_ || !same_pattern(k) || !same_values(k))
      factorise(k, is_symmetric);
    if (by_symmetric_) {
      Eigen::VectorXd x = symmetric_.solve(r);
      if (x.allFinite()) return x;
      factorise_general(true);
    }
    Eigen::VectorXd x = general_.solve(r);
    if (!x.allFinite()) refuse();
    return x;
  }

 private:
  void factorise(Matrix const& k, bool is_symmetric) {
    bool const same = has_matrix_ && is_symmetric == is_symmetric_ && same_pattern(k);
    matrix_ = k;
    has_matrix_ = true;
    is_symmetric_ = is_symmetric;
    has_factors_ = by_symmetric_ = false;
    if (!same) symmetric_analysed_ = general_analysed_ = false;
    if (is_symmetric) {
      if (!symmetric_analysed_) {
        symmetric_.analyzePattern(matrix_);
        symmetric_analysed_ = true;
        ++analyses_;
      }
      symmetric_.factorize(matrix_);
      ++factorisations_;
      if (symmetric_.info() == Eigen::Success) {
        Eigen::VectorXd const pivots = symmetric_.vectorD().cwiseAbs();
        // Rounding makes a pivot that should be zero some 1e-16 of the others.
        if (pivots.size() > 0 && pivots.minCoeff() < 1e-13 * pivots.maxCoeff()) refuse();
        by_symmetric_ = has_factors_ = true;
        negative_pivots_ = symmetric_.vectorD().size() > 0 && symmetric_.vectorD().minCoeff() < 0;
        count_operations();
        return;
      }
    }
    factorise_general(!general_analysed_);
  }
  void count_operations() {
    auto const& factor = symmetric_.matrixL().nestedExpression();
    double multiplications = 0;
    for (Eigen::Index column = 0; column < factor.cols(); ++column) {
      auto const below =
          static_cast<double>(factor.outerIndexPtr()[column + 1] - factor.outerIndexPtr()[column]);
      multiplications += below * below / 2;
    }
    solves_worth_ = static_cast<int>(
        multiplications / (2.0 * static_cast<double>(factor.nonZeros() + matrix_.nonZeros()) + 1));
  }
  void factorise_general(bool analyse) {
    has_factors_ = by_symmetric_ = false;
    if (analyse) {
      general_.analyzePattern(matrix_);
      general_analysed_ = true;
      ++analyses_;
    }
    general_.factorize(matrix_);
    ++factorisations_;
    if (general_.info() != Eigen::Success) refuse();
    has_factors_ = true;
  }
  [[noreturn]] void refuse() {
    has_factors_ = false;
    throw Error(name_,
                ": the matrix is singular; hold the body against rigid motion, or look for a "
                "collapsed element");
  }
  bool same_pattern(Matrix const& k) const {
    return k.rows() == matrix_.rows() && k.nonZeros() == matrix_.nonZeros() &&
           std::equal(k.outerIndexPtr(), k.outerIndexPtr() + k.outerSize() + 1,
                      matrix_.outerIndexPtr()) &&
           std::equal(k.innerIndexPtr(), k.innerIndexPtr() + k.nonZeros(), matrix_.innerIndexPtr());
  }
  bool same_values(Matrix const& k) const {
    return std::equal(k.valuePtr(), k.valuePtr() + k.nonZeros(), matrix_.valuePtr());
  }

  std::string name_;
  Matrix matrix_;
  Eigen::SimplicialLDLT<Matrix> symmetric_;
  Eigen::SparseLU<Matrix> general_;
  bool has_matrix_ = false, has_factors_ = false, by_symmetric_ = false, is_symmetric_ = false;
  bool negative_pivots_ = false;
  bool symmetric_analysed_ = false, general_analysed_ = false;
  int analyses_ = 0, factorisations_ = 0, solves_worth_ = 0;
};

PLIANT_COMPILED_ONCE DirectSolver::DirectSolver(std::string name)
    : factors_(std::make_unique<Factors>(std::move(name))) {}
PLIANT_COMPILED_ONCE DirectSolver::DirectSolver(DirectSolver&&) noexcept = default;
PLIANT_COMPILED_ONCE DirectSolver& DirectSolver::operator=(DirectSolver&&) noexcept = default;
PLIANT_COMPILED_ONCE DirectSolver::~DirectSolver() = default;

PLIANT_COMPILED_ONCE int DirectSolver::analyses() const { return factors_->analyses(); }
PLIANT_COMPILED_ONCE int DirectSolver::factorisations() const { return factors_->factorisations(); }
PLIANT_COMPILED_ONCE int DirectSolver::solves_worth_a_factorisation() const {
  return factors_->solves_worth_a_factorisation();
}
PLIANT_COMPILED_ONCE bool DirectSolver::indefinite() const { return factors_->indefinite(); }
PLIANT_COMPILED_ONCE bool DirectSolver::fits(Eigen::Index rows) const {
  return factors_->fits(rows);
}
PLIANT_COMPILED_ONCE Eigen::VectorXd DirectSolver::apply(Eigen::VectorXd const& r) const {
  return factors_->apply(r);
}
PLIANT_COMPILED_ONCE Eigen::VectorXd DirectSolver::solve(Matrix const& k, Eigen::VectorXd const& r,
                                                         bool is_symmetric) {
  return factors_->solve(k, r, is_symmetric);
}

}  // namespace pliant::detail
