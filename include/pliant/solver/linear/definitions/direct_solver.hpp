#pragma once

#include <algorithm>
#include <utility>

#include <Eigen/SparseLU>

#include <pliant/error.hpp>
#include <pliant/solver/linear/definitions/symmetric_factors.hpp>
#include <pliant/solver/linear/direct_solver.hpp>

namespace pliant::detail {

class DirectSolver::Factors {
 public:
  explicit Factors(std::string name) : name_(std::move(name)) {}

  int analyses() const { return analyses_; }
  int factorisations() const { return factorisations_; }

  int solves_worth_a_factorisation() const { return is_symmetric_by() ? solves_worth_ : 0; }
  bool indefinite() const { return is_symmetric_by() && indefinite_; }
  bool fits(Eigen::Index rows) const { return by_ != By::none && matrix_.rows() == rows; }
  Eigen::VectorXd apply(Eigen::VectorXd const& r) const {
#if defined(PLIANT_CHOLMOD)
    if (by_ == By::supernodal) return supernodal_.solve(r);
#endif
    return simplicial_.solve(r);
  }

  Eigen::VectorXd solve(Matrix const& k, Eigen::VectorXd const& r, bool is_symmetric) {
    if (by_ == By::none || is_symmetric != is_symmetric_ || !same_pattern(k) || !same_values(k))
      factorise(k, is_symmetric);
    if (by_ != By::general) {
      Eigen::VectorXd x = apply(r);
      if (x.allFinite()) return x;
      factorise_general(true);
    }
    Eigen::VectorXd x = general_.solve(r);
    if (!x.allFinite()) refuse();
    return x;
  }

 private:
  enum class By { none, simplicial, supernodal, general };

  bool is_symmetric_by() const { return by_ == By::simplicial || by_ == By::supernodal; }
  void factorise(Matrix const& k, bool is_symmetric) {
    bool const same = has_matrix_ && is_symmetric == is_symmetric_ && same_pattern(k);
    matrix_ = k;
    has_matrix_ = true;
    is_symmetric_ = is_symmetric;
    by_ = By::none;
    if (!same) simplicial_analysed_ = supernodal_analysed_ = general_analysed_ = false;
    if (is_symmetric) {
#if defined(PLIANT_CHOLMOD)
      if (matrix_.rows() >= many_ &&
          factorise_symmetric(supernodal_, By::supernodal, supernodal_analysed_))
        return;
#endif
      if (factorise_symmetric(simplicial_, By::simplicial, simplicial_analysed_)) return;
    }
    factorise_general(!general_analysed_);
  }
  /// False where these factors are not for the matrix.
  template <class SymmetricFactors>
  bool factorise_symmetric(SymmetricFactors& factors, By by, bool& analysed) {
    if (!analysed) {
      factors.analyse(matrix_);
      analysed = true;
      ++analyses_;
    }
    if constexpr (requires { factors.pays(); })
      if (!factors.pays()) return false;
    ++factorisations_;
    auto const found = factors.factorise(matrix_);
    if (found == Definiteness::not_factorised) return false;
    if (found == Definiteness::singular) refuse();
    by_ = by;
    indefinite_ = found == Definiteness::indefinite;
    solves_worth_ = static_cast<int>(factors.solves_worth_a_factorisation(matrix_.nonZeros()));
    return true;
  }
  void factorise_general(bool analyse) {
    by_ = By::none;
    if (analyse) {
      general_.analyzePattern(matrix_);
      general_analysed_ = true;
      ++analyses_;
    }
    general_.factorize(matrix_);
    ++factorisations_;
    if (general_.info() != Eigen::Success) refuse();
    by_ = By::general;
  }
  [[noreturn]] void refuse() {
    by_ = By::none;
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
  SimplicialFactors simplicial_;
#if defined(PLIANT_CHOLMOD)
  /// Rows from where on dense blocks may be faster.
  static constexpr Eigen::Index many_ = 1000;
  SupernodalFactors supernodal_;
#endif
  Eigen::SparseLU<Matrix> general_;
  By by_ = By::none;
  bool has_matrix_ = false, is_symmetric_ = false, indefinite_ = false;
  bool simplicial_analysed_ = false, supernodal_analysed_ = false, general_analysed_ = false;
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
