#pragma once

namespace pliant {

/// By what Krylov methods without a matrix are preconditioned.
enum class Preconditioner {
  automatic,     // nodal blocks, and multigrid where these turn out to take many iterations
  nodal_blocks,  // the inverse blocks of the diagonal, of a node each
  chebyshev,     // a polynomial of the matrix and these
  multigrid      // functions of grids around the body, smoothed by such polynomials
};

}  // namespace pliant
