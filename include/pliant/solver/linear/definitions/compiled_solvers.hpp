#pragma once

#include <pliant/solver/linear/compiled_once.hpp>

#if defined(PLIANT_COMPILED_SOLVERS)
namespace pliant::detail {
template <int EigenAlignment>
int const CompiledSolvers<EigenAlignment>::need_the_same_march_in_all_sources = EigenAlignment;
template struct CompiledSolvers<EIGEN_MAX_ALIGN_BYTES>;
}  // namespace pliant::detail
#endif
