#pragma once

#include <string>

#include <benchmark/benchmark.h>

#include "support/backends.hpp"
#include "support/formulations.hpp"
#include "support/measure.hpp"
#include "support/meshes.hpp"

namespace pliant::bench {

/// Registers run(state), whose time is what it says.
template <class Run>
void add_named(std::string const& name, Run run) {
  benchmark::RegisterBenchmark(name.c_str(), with_memory(std::move(run)))
      ->UseManualTime()
      ->Unit(benchmark::kMicrosecond);
}

/// what/element/law/precision/backend/elements.
template <class F, class T>
std::string name_of_mesh(std::string const& what, std::string const& backend, long elements) {
  return what + "/" + F::element::name() + "/" + law_name<F>() + "/" + precision_name<T>() + "/" +
         backend + "/" + std::to_string(elements);
}
template <class F, class T>
std::string name_of(std::string const& what, std::string const& backend, int cells) {
  return name_of_mesh<F, T>(what, backend, element_count<typename F::element>(cells));
}
/// Registers it under that name.
template <class F, class T, class Run>
void add(std::string const& what, std::string const& backend, int cells, Run run) {
  add_named(name_of<F, T>(what, backend, cells), std::move(run));
}

/// The same for what is measured once.
template <class F, class T, class Run>
void add_once(std::string const& what, std::string const& backend, int cells, Run run) {
  benchmark::RegisterBenchmark(name_of<F, T>(what, backend, cells).c_str(), std::move(run))
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

/// The cells along an edge of the usual mesh: large enough to leave the caches, and to fill a GPU.
template <Element E, class B>
int usual_cells() {
  return cells_for<E>((on_gpu<B> ? 1e6 : 2e5) / (E::nodes >= 20 ? 8 : 1));
}
/// Where starting a loop counts: within the caches of a CPU; where a GPU has little to hide latency.
template <Element E, class B>
int few_cells() {
  return cells_for<E>(on_gpu<B> ? 48e3 : 6e3);
}
/// Where nothing but the rate counts; for a GPU.
template <Element E>
int many_cells() {
  return cells_for<E>(20e6);
}

}  // namespace pliant::bench
