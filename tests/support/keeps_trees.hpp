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

/// Lets the host change a body's mesh, beside which others are compared.
template <class TheBody>
void change_on_host(TheBody& body) {
  body.parts().host_changes.take_all();
}

#if defined(__CUDACC__)
using KeepingBackends = DoubleBackends;
using KeepingFloat = Cuda<float>;
#else
/// The main one alone: what is changed there stands on verbs, which tests/backend compares.
using KeepingBackends = std::tuple<KeepsTrees<MainBackend> >;
#if defined(_OPENMP)
using KeepingFloat = KeepsTrees<OpenMP<float> >;
#else
using KeepingFloat = KeepsTrees<Reference<float> >;
#endif
#endif

}  // namespace pliant::test
