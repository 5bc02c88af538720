#pragma once

/// Stands before functions that are no templates and rest on Eigen's solvers, which take a compiler longer than a body
/// does. They are inline, or compiled once: PLIANT_COMPILED_SOLVERS leaves their definitions out of the headers, and
/// pliant/solver/compiled.cpp, which the CMake target pliant::solvers adds to a program, has them.
#if defined(PLIANT_COMPILED_SOLVERS)
#include <Eigen/Core>

#define PLIANT_COMPILED_ONCE

namespace pliant::detail {
/// Eigen aligns what it allocates by the registers that a source is compiled for, and what one source allocates another
/// frees. Defined for those of compiled.cpp alone, so that a program whose sources differ does not link.
template <int EigenAlignment>
struct CompiledSolvers {
  static int const need_the_same_march_in_all_sources;
};
[[gnu::used]] inline int const* const compiled_solvers =
    &CompiledSolvers<EIGEN_MAX_ALIGN_BYTES>::need_the_same_march_in_all_sources;
}  // namespace pliant::detail
#else
#define PLIANT_COMPILED_ONCE inline
#endif
