#pragma once

#include <tuple>

#include <pliant/backend/dispatch.hpp>
#include <pliant/backend/kernel.hpp>
#include <pliant/cuda/elements.hpp>
#include <pliant/cuda/launch.hpp>
#include <pliant/cuda/vector_memory.cuh>

namespace pliant::detail {

/// Elements that one thread looks at: several where most are passed over, so that loads overlap.
template <class Visitor>
inline constexpr int visits_per_thread = Selects<Visitor> ? 8 : 1;

/// Blocks that a multiprocessor holds at least: 64 registers for a thread, 128 in double, where few elements would
/// take more (bench/adaptation, migration).
template <class Visitor, class Field, class...>
inline constexpr int visit_blocks =
    FinishesFew<Visitor> ? 32 / static_cast<int>(sizeof(typename Field::value_type)) : 1;

/// What gathers fields at the nodes of an element, and adds to them.
template <int Nodes, class Gathers>
struct AtNodes : Gathers {
  Index const* row;
  template <class T, int C>
  __device__ void add(NodeField<T, C> const& out, Matrix<T, Nodes, C> const& shares) const {
    for (int a = 0; a < Nodes; ++a) add_to_node(out, row[a], shares.entries[a]);
  }
};
template <int Nodes, class Gathers>
__device__ AtNodes<Nodes, Gathers> at_nodes(Gathers const& gathers, Index const* row) {
  return {gathers, row};
}

/// Tallies are collected per block, so that few reach global memory.
template <int Groups, int Nodes, class Visitor, class... Fields>
__global__ void __launch_bounds__(visit_threads, visit_blocks<Visitor, Fields...>)
    visit_elements(ElementView<Nodes> const elements, __grid_constant__ Visitor const visitor,
                   double* counters, Fields... fields) {
  constexpr int count = Visitor::counters;
  __shared__ double tallies[count > 0 ? count : 1];
  int const thread = static_cast<int>(threadIdx.x);
  for (int k = thread; k < count; k += visit_threads) tallies[k] = 0;
  __syncthreads();
  begin_after_previous_kernel();

  auto const visit = [&](Index e, Tag tag) {
    Index const* const row =
        elements.connectivity + static_cast<std::ptrdiff_t>(elements.width) * e;
    dispatch<Groups>(tag, [&](auto group) {
      auto const again =
          at_nodes<Nodes>([&] { return std::tuple{gather_nodes<Nodes>(fields, row)...}; }, row);
      auto const tally = [&](int k, double x) { atomicAdd(tallies + k, x); };
      auto const values =
          evaluate_at(visitor, group, OneElement{e}, gather_nodes<Nodes>(fields, row)...);
      visitor.finish(group, e, values, again, tally);
    });
  };
  constexpr int each = visits_per_thread<Visitor>;
  Index const first = static_cast<Index>(blockIdx.x) * visit_threads + thread;
  // Far from each other, since those that are selected may lie side by side.
  Index const apart = static_cast<Index>(gridDim.x) * visit_threads;
  if constexpr (each == 1) {
    if (Index const e = elements.element(first); e >= 0) visit(e, elements.tags[e]);
  } else {
    Index numbers[each];
    Tag tags[each];
    unsigned selected = 0;
#pragma unroll
    for (int k = 0; k < each; ++k) {
      numbers[k] = elements.element(first + k * apart);
      tags[k] = numbers[k] >= 0 ? elements.tags[numbers[k]] : no_group;
    }
#pragma unroll
    for (int k = 0; k < each; ++k)
      if (numbers[k] >= 0 && visitor.selects(numbers[k], tags[k])) selected |= 1u << k;
#pragma unroll 1
    for (; selected != 0; selected &= selected - 1) {
      Index const e = elements.element(first + (__ffs(static_cast<int>(selected)) - 1) * apart);
      visit(e, elements.tags[e]);
    }
  }
  __syncthreads();
  for (int k = thread; k < count; k += visit_threads)
    if (tallies[k] != 0) atomicAdd(counters + k, tallies[k]);
}

}  // namespace pliant::detail
