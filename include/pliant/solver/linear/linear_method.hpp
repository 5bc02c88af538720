#pragma once

namespace pliant {

/// How linear systems are solved.
enum class LinearMethod {
  automatic,  // by the number of unknowns and what the matrix turns out to be
  direct,     // by a factorisation
  multilevel,  // by conjugate gradients with smoothed aggregation, as long as the matrix is positive definite
  matrix_free  // by conjugate gradients on the body's backend, on products of the tangent and inverse blocks of nodes
};

/// What the linear systems of a solve took.
struct LinearReport {
  LinearMethod method = LinearMethod::direct;  // of the last one
  int factorisations = 0;
  int hierarchies = 0;  // of matrices, made for the multilevel method
  int iterations = 0;   // of conjugate gradients
};

}  // namespace pliant
