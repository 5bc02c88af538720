#pragma once

#include <memory>
#include <vector>

#include <pliant/mesh/mesh.hpp>
#include <pliant/solver/linear/block_matrix.hpp>

namespace pliant::detail {

/// An approximation of A⁻¹ r for stiffnesses A: one V-cycle over ever coarser matrices, by smoothed aggregation (Vaněk,
/// Mandel, Brezina, Algebraic multigrid by smoothed aggregation for second and fourth order elliptic problems,
/// Computing 56 (1996) 179). Symmetric, and positive definite where A is.
template <int Dim>
class Multilevel {
 public:
  /// `a` has the identity, times any factor, in rows and columns of fixed directions.
  Multilevel(HostTasks const& tasks, BlockMatrix<Dim, Dim> a, std::vector<Point<Dim>> const& nodes,
             std::vector<bool> const& fixed);
  Multilevel(Multilevel&&) noexcept;
  Multilevel& operator=(Multilevel&&) noexcept;
  ~Multilevel();

  int levels() const;
  BlockMatrix<Dim, Dim> const& matrix() const;
  /// Blocks of all levels over those of the finest, by numbers in them.
  double operator_complexity() const;

  /// Whether the coarsest matrix is positive definite, and not by rounding alone: rigid motions that nothing holds are in it.
  bool is_definite() const;
  /// Only where is_definite().
  void apply(HostTasks const& tasks, Eigen::VectorXd const& r, Eigen::VectorXd& z);

 private:
  class Hierarchy;
  std::unique_ptr<Hierarchy> hierarchy_;
};

}  // namespace pliant::detail

#if !defined(PLIANT_COMPILED_SOLVERS)
#include <pliant/solver/linear/definitions/multilevel.hpp>
#endif
