#pragma once

#if defined(__CUDACC__)
#include <pliant/cuda.hpp>
#else
#include <pliant/openmp.hpp>
#endif

#include "work_precision/contest.hpp"

// What runs are measured on: threads of the CPU, or the GPU where nvcc compiles the program.
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

}  // namespace pliant::bench
