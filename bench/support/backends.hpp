#pragma once

#include <string>
#include <utility>

#include <pliant/pliant.hpp>

#if defined(__CUDACC__)
#include <pliant/cuda.hpp>
#else
#include <pliant/reference.hpp>
#if defined(_OPENMP)
#include <pliant/openmp.hpp>
#endif
#endif

// The backends that a suite is timed on: those of the CPU in a .cpp file, the GPU in a .cu file.
namespace pliant::bench {

/// Where a backend stands in a comparison.
enum class Role {
  main,    ///< everything is timed on it: OpenMP with one thread, or the GPU
  scalar,  ///< the plain loop beside it: Reference
  threads  ///< the same with two threads, and with all
};

/// Calls visit(backend, name, role) for each backend of this program.
template <class T, class Visit>
void on_each_backend(Visit const& visit) {
#if defined(__CUDACC__)
  static Cuda<T> const gpu;  // one stream for all
  visit(gpu, "Cuda", Role::main);
#elif defined(_OPENMP)
  visit(Reference<T>{}, "Reference", Role::scalar);
  visit(OpenMP<T>{{.threads = 1}}, "OpenMP-1", Role::main);
  int const all = OpenMP<T>{}.threads();
  if (all > 1) visit(OpenMP<T>{{.threads = 2}}, "OpenMP-2", Role::threads);
  if (all > 2)
    visit(OpenMP<T>{{.threads = all}}, ("OpenMP-" + std::to_string(all)).c_str(), Role::threads);
#else
  visit(Reference<T>{}, "Reference", Role::main);
#endif
}
/// The same in both precisions.
template <class Visit>
void on_each_backend_and_precision(Visit const& visit) {
  on_each_backend<float>(visit);
  on_each_backend<double>(visit);
}

template <class B>
inline constexpr bool on_gpu =
#if defined(__CUDACC__)
    true;
#else
    false;
#endif

}  // namespace pliant::bench
