#pragma once

namespace pliant {

/// By what Krylov methods without a matrix are preconditioned.
enum class Preconditioner {
  automatic,  // nodal blocks, and where these turn out to take many iterations multigrid, or, on CPUs, p_multigrid for
              // quadratic elements that do not lie in the boxes of a grid
  nodal_blocks,  // the inverse blocks of the diagonal, of a node each
  chebyshev,     // a polynomial of the matrix and these
  multigrid,     // functions of grids around the body, smoothed by such polynomials
  p_multigrid  // between the body's quadratic elements and the grids, linear ones on the same cells: where all elements
               // are quadratic and no node hangs; elsewhere multigrid takes its place
};

}  // namespace pliant
