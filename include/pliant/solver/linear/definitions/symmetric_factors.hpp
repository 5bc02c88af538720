#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#if defined(PLIANT_CHOLMOD)
#include <Eigen/CholmodSupport>
#endif

namespace pliant::detail {

/// What a factorisation tells of a symmetric matrix. Rounding makes a pivot that should be zero some 1e-16 of the
/// others; a matrix with one below 1e-13 of the largest counts as singular.
enum class Definiteness { definite, indefinite, singular, not_factorised };
inline constexpr double least_pivot = 1e-13;

/// L D Lᵀ, column by column: of any symmetric matrix that needs no pivoting.
class SimplicialFactors {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  void analyse(Matrix const& k) { factors_.analyzePattern(k); }
  Definiteness factorise(Matrix const& k) {
    factors_.factorize(k);
    if (factors_.info() != Eigen::Success) return Definiteness::not_factorised;
    auto const pivots = factors_.vectorD();
    if (pivots.size() == 0) return Definiteness::definite;
    if (pivots.cwiseAbs().minCoeff() < least_pivot * pivots.cwiseAbs().maxCoeff())
      return Definiteness::singular;
    return pivots.minCoeff() < 0 ? Definiteness::indefinite : Definiteness::definite;
  }
  Eigen::VectorXd solve(Eigen::VectorXd const& r) const { return factors_.solve(r); }

  /// How many solves, each with a product by the matrix of so many entries, take as many operations as the last
  /// factorisation.
  double solves_worth_a_factorisation(Eigen::Index entries) const {
    auto const& factor = factors_.matrixL().nestedExpression();
    double multiplications = 0;
    for (Eigen::Index column = 0; column < factor.cols(); ++column) {
      auto const below =
          static_cast<double>(factor.outerIndexPtr()[column + 1] - factor.outerIndexPtr()[column]);
      multiplications += below * below / 2;
    }
    return multiplications / (2.0 * static_cast<double>(factor.nonZeros() + entries) + 1);
  }

 private:
  Eigen::SimplicialLDLT<Matrix> factors_;
};

#if defined(PLIANT_CHOLMOD)
/// L Lᵀ by CHOLMOD, in dense blocks of columns (Chen, Davis, Hager, Rajamanickam, ACM TOMS 35(3), 2008): of definite
/// matrices.
class SupernodalFactors : private Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>> {
  using Base = Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>>;

 public:
  using Matrix = Eigen::SparseMatrix<double>;

  SupernodalFactors() {
    cholmod().print = 0;
    cholmod().quick_return_if_not_posdef = 1;
  }
  void analyse(Matrix const& k) {
    analyzePattern(k);
    operations_ = cholmod().fl;
    entries_ = cholmod().lnz;
  }
  /// Whether the matrix that was analysed is factorised faster than column by column.
  bool pays() const { return operations_ >= 100 * entries_; }
  Definiteness factorise(Matrix const& k) {
    factorize(k);
    if (info() != Eigen::Success) return Definiteness::not_factorised;
    // The least pivot over the largest.
    bool const regular = cholmod_rcond(m_cholmodFactor, &cholmod()) >= least_pivot;
    return regular ? Definiteness::definite : Definiteness::singular;
  }
  Eigen::VectorXd solve(Eigen::VectorXd const& r) const { return Base::solve(r); }
  double solves_worth_a_factorisation(Eigen::Index entries) const {
    double const multiplications = operations_ / 2;
    return multiplications / (2 * (entries_ + static_cast<double>(entries)) + 1) / faster_;
  }

 private:
  /// The rate of factorisations over that of solves.
  static constexpr double faster_ = 2.5;
  double operations_ = 0, entries_ = 0;  // of the factor
};
#endif

}  // namespace pliant::detail
