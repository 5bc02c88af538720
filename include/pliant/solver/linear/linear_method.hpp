#pragma once

#include <pliant/solver/linear/preconditioner.hpp>

namespace pliant {

/// How linear systems are solved.
enum class LinearMethod {
  automatic,   // by the number of unknowns and what the matrix turns out to be
  direct,      // by a factorisation
  multilevel,  // by conjugate gradients with smoothed aggregation, or MINRES while that of an earlier matrix serves an
               // indefinite one; by factors where neither will do
  matrix_free  // by a KrylovMethod on the body's backend, on products of the tangent: see Preconditioner
};

/// What the linear systems of a solve took.
struct LinearReport {
  LinearMethod method = LinearMethod::direct;  // of the last one
  int factorisations = 0;
  int hierarchies = 0;  // of matrices, made for the multilevel method or multigrid
  int iterations = 0;   // of conjugate gradients and MINRES
  int minres = 0;       // linear systems that MINRES solved, or ended
  /// Without a matrix: what preconditioned in the end, of how many matrices it was made, and the time that this took.
  Preconditioner preconditioner = Preconditioner::nodal_blocks;
  int levels = 1;
  double setup = 0;  // s, of chebyshev and multigrid
  int fallbacks =
      0;  // linear systems in which these turned out not to be positive definite, and nodal blocks went on
};

}  // namespace pliant
