#pragma once

/// Stands before functions that are no templates and rest on Eigen's solvers, which take a compiler longer than a body
/// does. They are inline, or compiled once: PLIANT_COMPILED_SOLVERS leaves their definitions out of the headers, and
/// pliant/solver/compiled.cpp, which the CMake target pliant::solvers adds to a program, has them.
#if defined(PLIANT_COMPILED_SOLVERS)
#define PLIANT_COMPILED_ONCE
#else
#define PLIANT_COMPILED_ONCE inline
#endif
