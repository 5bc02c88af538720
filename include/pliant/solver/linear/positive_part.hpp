#pragma once

#include <Eigen/Core>

#include <pliant/solver/linear/compiled_once.hpp>

namespace pliant::detail {

/// Replaces a symmetric matrix by the nearest one, in Frobenius' norm, that is positive semidefinite: its negative eigenvalues
/// become zero. Leaves alone what has none but of rounding, and what is not finite.
void keep_positive_part(Eigen::Ref<Eigen::MatrixXd> a);

}  // namespace pliant::detail

#if !defined(PLIANT_COMPILED_SOLVERS)
#include <pliant/solver/linear/definitions/positive_part.hpp>
#endif
