#pragma once

#if defined(__CUDACC__)
#include <pliant/cuda.hpp>
#else
#include <pliant/openmp.hpp>
#endif

#include <pliant/pliant.hpp>

#include "work_precision/contest.hpp"

// What runs are measured on: threads of the CPU, or the GPU where nvcc compiles the program; and what their bodies are made of.
namespace pliant::bench {

#if defined(__CUDACC__)
template <class T>
Cuda<T> backend(int) {
  return {};
}
#else
template <class T>
OpenMP<T> backend(int threads) {
  return OpenMP<T>{{.threads = threads}};
}
#endif

/// The group of a formulation that a problem's or scene's elements are in.
template <class Problem, class F, class M>
Group<F> group_in(M const& mesh) {
  if constexpr (requires { Problem::template group<F>(mesh); })
    return Problem::template group<F>(mesh);
  else
    return {};
}

}  // namespace pliant::bench
