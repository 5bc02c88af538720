#pragma once

#include <tuple>

#include "support/backends.hpp"

namespace pliant::test {

/// A backend of the host that changes meshes in its memory, as a GPU does.
template <class B>
struct KeepsTrees : B {
  static constexpr bool keeps_trees = true;
  KeepsTrees() = default;
};

#if defined(__CUDACC__)
using KeepingBackends = Backends<double>;
using KeepingFloat = Cuda<float>;
#elif defined(_OPENMP)
using KeepingBackends = std::tuple<KeepsTrees<Reference<double> >, KeepsTrees<OpenMP<double> > >;
using KeepingFloat = KeepsTrees<OpenMP<float> >;
#else
using KeepingBackends = std::tuple<KeepsTrees<Reference<double> > >;
using KeepingFloat = KeepsTrees<Reference<float> >;
#endif

}  // namespace pliant::test
