#pragma once

#include <pliant/cuda.hpp>

#include "support/backends.hpp"

// What the backend's accumulation is compared with: one thread per element, no patches.
namespace pliant::bench {

/// What a plain kernel does with an element's forces.
enum class Ending {
  scatter,  ///< adds them to the nodes: one vector instruction each in single precision
  none      ///< drops them: the rate of gathering and computing alone
};

template <Ending Which, int Nodes, class T, int C, class Kernel, class... Fields>
__global__ void __launch_bounds__(128)
    plain_force(pliant::detail::ElementView<Nodes> const elements,
                __grid_constant__ Kernel const kernel, NodeField<T, C> const out,
                Fields... fields) {
  Index const e = static_cast<Index>(blockIdx.x * blockDim.x + threadIdx.x);
  if (e >= elements.count) return;
  Index nodes[Nodes];
  pliant::detail::load_padded<Nodes>(
      elements.connectivity + static_cast<std::ptrdiff_t>(elements.width) * e, nodes);
  auto const shares =
      kernel(GroupNumber<0>{}, pliant::detail::gather_nodes<Nodes>(fields, nodes)...);
  if constexpr (Which == Ending::scatter) {
#pragma unroll
    for (int a = 0; a < Nodes; ++a) pliant::detail::add_to_node(out, nodes[a], shares.entries[a]);
  } else {
    T sum(0);
#pragma unroll
    for (int a = 0; a < Nodes; ++a)
#pragma unroll
      for (int k = 0; k < C; ++k) sum += shares(a, k) * T(a + Nodes * k + 1);
    if (sum == T(0.12345)) out(nodes[0], 0) = sum;  // never, but the compiler cannot know
  }
}

template <Ending Which, int Nodes, class T, class Kernel, int C, class... Fields>
void launch_plain(Cuda<T> const& backend, CudaElements<T, Nodes> const& elements,
                  Kernel const& kernel, NodeField<T, C> out, Fields const&... fields) {
  constexpr int threads = 128;
  void (*const plain)(pliant::detail::ElementView<Nodes>, Kernel, NodeField<T, C>, Fields...) =
      plain_force<Which, Nodes, T, C, Kernel, Fields...>;
  pliant::detail::launch("plain force", {(elements.count() + threads - 1) / threads, threads},
                         backend.stream(), plain, elements.view({nullptr}), kernel, out, fields...);
}

}  // namespace pliant::bench
