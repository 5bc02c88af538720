#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pliant/mesh/mesh.hpp>
#include <pliant/solver/linear/linear_method.hpp>
#include <pliant/solver/linear/unknowns.hpp>

namespace pliant::detail {

/// The stiffness of a body, or a sum with its mass, and what is unknown.
template <int Dim>
struct LinearSystem {
  BlockMatrix<Dim, Dim> const& matrix;
  Unknowns const& unknowns;
  std::vector<Point<Dim>> const& nodes;
  bool symmetric;
};

/// Solves systems that follow each other. Factors and hierarchies of an earlier matrix serve later ones, as
/// preconditioners of conjugate gradients, while that is less work than to make them anew.
template <int Dim>
class LinearSolver {
 public:
  /// `name`: whose errors these are.
  explicit LinearSolver(std::string name, LinearMethod method = LinearMethod::automatic);
  LinearSolver(LinearSolver&&) noexcept;
  LinearSolver& operator=(LinearSolver&&) noexcept;
  ~LinearSolver();

  /// |r − A x| / |r| of the last solve; 0 by factors.
  double reached() const;
  /// Whether the last matrix is known to be indefinite.
  bool indefinite() const;
  LinearReport report() const;

  /// What follows does not depend on what was solved so far: factors and hierarchies serve for their own matrix alone.
  void begin_anew();

  /// x with |r − A x| ≤ tolerance |r| over the unknowns, and 0 elsewhere; at least as accurate where it factorises.
  /// Throws Error where the matrix is singular.
  Eigen::VectorXd solve(HostTasks const& tasks, LinearSystem<Dim> const& system, Eigen::VectorXd r,
                        double tolerance);

 private:
  class Methods;
  std::unique_ptr<Methods> methods_;
};

}  // namespace pliant::detail

#if !defined(PLIANT_COMPILED_SOLVERS)
#include <pliant/solver/linear/definitions/linear_solver.hpp>
#endif
