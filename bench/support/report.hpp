#pragma once

#include <benchmark/benchmark.h>

#include "support/problem.hpp"

// What a benchmark says beside its time.
namespace pliant::bench {

/// Values per node that a kernel has to move, whatever it does.
struct NodeTraffic {
  int read;     // fields of dim values
  int written;  // fields of dim values
};

/// The mandatory traffic, bytes: connectivity once (4 per node of an element), each value of a node
/// once (dim of them per field, without padding). A Tet4 force in single precision: 16 for the
/// element and 36 for its sixth of a node, 22.
template <Element E, class T>
double mandatory_bytes(double elements, double nodes, NodeTraffic const& traffic) {
  return elements * E::nodes * sizeof(Index) +
         nodes * (traffic.read + traffic.written) * E::dim * sizeof(T);
}

inline void report_rate(benchmark::State& state, char const* what, double per_iteration) {
  state.counters[what] =
      benchmark::Counter(per_iteration, benchmark::Counter::kIsIterationInvariantRate);
}

template <class B, Element E>
void report(benchmark::State& state, Problem<B, E> const& problem, NodeTraffic const& traffic,
            double more_bytes_per_element = 0, double flops_per_element = 0) {
  using T = typename B::scalar;
  auto const elements = static_cast<double>(problem.elements.count());
  state.counters["elements"] = elements;
  report_rate(state, "items_per_second", elements);
  report_rate(
      state, "bytes_per_second",
      mandatory_bytes<E, T>(elements, problem.nodes, traffic) + elements * more_bytes_per_element);
  if (flops_per_element > 0) report_rate(state, "flops", elements * flops_per_element);
}

/// Floating-point operations of one force, where they were counted; 0 elsewhere.
template <Element E>
constexpr double flops_per_force() {
  if (std::same_as<E, Tet4>) return 265;
  if (std::same_as<E, Hex8>) return 2734;
  return 0;
}

}  // namespace pliant::bench
