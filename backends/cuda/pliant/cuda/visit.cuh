#pragma once

#include <tuple>

#include <pliant/backend/dispatch.hpp>
#include <pliant/cuda/elements.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/vector_memory.cuh>

namespace pliant::detail {

/// One thread per element. Tallies are collected per block, so that few reach global memory.
template <int Groups, int Nodes, class Visitor, class... Fields>
__global__ void __launch_bounds__(visit_threads)
    visit_elements(ElementView<Nodes> const elements, __grid_constant__ Visitor const visitor,
                   double* counters, Fields... fields) {
  constexpr int count = Visitor::counters;
  __shared__ double tallies[count > 0 ? count : 1];
  int const thread = static_cast<int>(threadIdx.x);
  for (int k = thread; k < count; k += visit_threads) tallies[k] = 0;
  __syncthreads();
  begin_after_previous_kernel();

  Index const e = elements.element(static_cast<Index>(blockIdx.x) * visit_threads + thread);
  if (e >= 0) {
    Index const* const row =
        elements.connectivity + static_cast<std::ptrdiff_t>(elements.width) * e;
    dispatch<Groups>(elements.tags[e], [&](auto group) {
      auto const again = [&] { return std::tuple{gather_nodes<Nodes>(fields, row)...}; };
      auto const tally = [&](int k, double x) { atomicAdd(tallies + k, x); };
      auto const values =
          evaluate_at(visitor, group, OneElement{e}, gather_nodes<Nodes>(fields, row)...);
      visitor.finish(group, e, values, again, tally);
    });
  }
  __syncthreads();
  for (int k = thread; k < count; k += visit_threads)
    if (tallies[k] != 0) atomicAdd(counters + k, tallies[k]);
}

}  // namespace pliant::detail
