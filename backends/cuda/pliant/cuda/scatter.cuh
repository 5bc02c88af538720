#pragma once

#include <pliant/backend/dispatch.hpp>
#include <pliant/cuda/elements.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/vector_memory.cuh>

namespace pliant::detail {

/// One thread per element, which adds its shares to its nodes in global memory.
template <int Groups, int Nodes, class T, int C, class Kernel, class... Fields>
__global__ void __launch_bounds__(scatter_threads, (scatter_blocks<Nodes, C, sizeof...(Fields)>))
    scatter_elements(ElementView<Nodes> const elements, __grid_constant__ Kernel const kernel,
                     NodeField<T, C> const out, Fields... fields) {
  begin_after_previous_kernel();
  Index const e = elements.element(static_cast<Index>(blockIdx.x) * scatter_threads +
                                   static_cast<Index>(threadIdx.x));
  if (e < 0) return;
  Index const* const row = elements.connectivity + static_cast<std::ptrdiff_t>(elements.width) * e;
  dispatch<Groups>(elements.tags[e], [&](auto group) {
    auto const shares = call(kernel, group, OneElement{e}, gather_nodes<Nodes>(fields, row)...);
#pragma unroll
    for (int a = 0; a < Nodes; ++a) add_to_node(out, row[a], shares.entries[a]);
  });
}

}  // namespace pliant::detail
