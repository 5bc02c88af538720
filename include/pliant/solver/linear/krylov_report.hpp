#pragma once

namespace pliant::detail {

struct KrylovReport {
  int iterations = 0;
  double residual = 0;  // |b − A x|, computed from x
  bool converged = false;
  bool indefinite =
      false;  // a direction p with pᵀ A p ≤ 0 was met, or a residual r with rᵀ M r ≤ 0
};

}  // namespace pliant::detail
