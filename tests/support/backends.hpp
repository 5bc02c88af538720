#pragma once

#include <tuple>
#include <type_traits>

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

/// One that reads a host's memory.
#if defined(__CUDACC__)
using HostBackend = Reference<double>;
#else
using HostBackend = MainBackend;
#endif

/// The main one in double precision, for what stands on the verbs alone, which tests/backend compares. A build
/// without OpenMP has the serial one there.
using MainAlone = std::tuple<MainBackend>;
/// Whether suites run on all of a CPU's backends: those of tests/backend and tests/formulation always do. The others take
/// longer to compile then; see tests/run.
#if defined(PLIANT_TEST_ALL) || !defined(_OPENMP) || defined(__CUDACC__)
inline constexpr bool on_all_backends = true;
#else
inline constexpr bool on_all_backends = false;
#endif
/// Whether a suite over several elements or meshes runs all of them on a backend; on the others a few will do.
template <class B>
#if defined(__CUDACC__)
inline constexpr bool runs_all = true;
#else
inline constexpr bool runs_all = std::same_as<B, MainBackend>;
#endif
/// Each backend in each precision: what tests backends themselves.
using AllPairs = decltype(std::tuple_cat(Backends<float>{}, Backends<double>{}));
/// Each backend and each precision, on CPUs in pairs: what rounds.
#if defined(_OPENMP) && !defined(__CUDACC__)
using PairedBackends = std::tuple<Reference<float>, OpenMP<double>>;
#else
using PairedBackends = AllPairs;
#endif
/// The same, and those of double precision, where suites run on all; else the main one.
using AllBackends = std::conditional_t<on_all_backends, PairedBackends, MainAlone>;
using DoubleBackends = std::conditional_t<on_all_backends, Backends<double>, MainAlone>;
/// For what neither rounds nor stands on more than the verbs: on CPUs the main one alone.
#if defined(_OPENMP) && !defined(__CUDACC__)
using FewBackends = MainAlone;
#else
using FewBackends = AllPairs;
#endif

}  // namespace pliant::test
