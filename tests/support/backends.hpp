#pragma once

#include <tuple>

#include <pliant/pliant.hpp>
#include <pliant/reference.hpp>

#if defined(__CUDACC__)
#include <pliant/cuda.hpp>
#elif defined(_OPENMP)
#include <pliant/openmp.hpp>
#endif

// The backends that a suite runs on: those of the CPU in a .cpp file, the GPU in a .cu file.
namespace pliant::test {

#if defined(__CUDACC__)
template <class T>
using Backends = std::tuple<Cuda<T>>;
using MainBackend = Cuda<double>;
#elif defined(_OPENMP)
template <class T>
using Backends = std::tuple<Reference<T>, OpenMP<T>>;
using MainBackend = OpenMP<double>;
#else
template <class T>
using Backends = std::tuple<Reference<T>>;
using MainBackend = Reference<double>;
#endif

using DoubleBackends = Backends<double>;
/// Each backend in each precision: what tests backends themselves.
using AllPairs = decltype(std::tuple_cat(Backends<float>{}, Backends<double>{}));
/// Each backend and each precision, on CPUs in pairs.
#if defined(_OPENMP) && !defined(__CUDACC__)
using AllBackends = std::tuple<Reference<float>, OpenMP<double>>;
#else
using AllBackends = AllPairs;
#endif

}  // namespace pliant::test
